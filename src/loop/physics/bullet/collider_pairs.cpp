#include "loop/physics/bullet/collider_pairs.hpp"

#include "loop/physics/bullet/bullet_types.hpp"
#include "loop/physics/bullet/joint_rows.hpp"
#include "loop/physics/segment_distance.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace wholehand::bullet {
namespace {

constexpr double kAround_m = 0.03;     // a fast hand moves this far in 30 ms
constexpr double kDeep_m = 1e-3;       // overlaps beyond this count as deep
constexpr double kApart_m = 1e-4;      // smallest distance of two points of a patch
constexpr double kOneSurface = 0.7;    // cosine above which two normals belong to one surface
constexpr double kSame = 1.0 - 1e-10;  // cosine above which a capsule lies on both pieces
constexpr double kBeside_m = 5e-3;     // points nearer than this lie beside each other
// Largest number of pieces whose inner edges are removed, which bounds the time of a tick. A hand
// that touches more pieces at once feels the edges of the rest.
constexpr std::size_t kMostPieces = 64;

bool meetsHand(BulletBody::Meets meets, bool palm) {
  return meets == BulletBody::Meets::kAll || (meets == BulletBody::Meets::kDigits) == !palm;
}

/// True when the two bodies never collide, as SceneBody::passes().
bool passes(const btRigidBody& a, const btRigidBody& b) {
  const auto stands = [](const btRigidBody& body) { return body.getInvMass() == 0.0; };
  const bool a_on_joint = jointOf(a) != nullptr, b_on_joint = jointOf(b) != nullptr;
  return (a_on_joint && (b_on_joint || stands(b))) || (b_on_joint && stands(a));
}

bool meetsBodies(BulletBody::Meets meets) {
  return meets != BulletBody::Meets::kDigits;
}

/// Number of pairs of overlapping boxes for which memory is reserved: all pairs of a small scene;
/// in a large one, more than can overlap at once.
std::size_t mostPairs(std::size_t colliders) {
  return std::min(colliders * colliders / 2, 32 * colliders + 1024);
}

std::vector<int> ownersOf(const std::vector<BulletBody>& bodies) {
  std::vector<int> owners;
  for (const BulletBody& body : bodies) {
    for (const auto& collider : body.colliders()) owners.push_back(collider->tag.body);
  }
  return owners;
}

/// True when a collider deep inside a body is now nearer to another side of it. Its old normal then
/// stays, so that it is pushed out on the side where it came in.
bool passedThrough(const btPersistentManifold& before, const ContactPatch& now) {
  return now.count > 0 && before.getNumContacts() > 0 && now.points[0].gap_m < -kDeep_m &&
         now.points[0].normal.dot(before.getContactPoint(0).m_normalWorldOnB) < 0.5;
}

/// A contact point seen from the collider that touches the other one.
struct SurfacePoint {
  btVector3 at_m, normal;  ///< on the other's surface; towards the collider
  double gap_m;
};

/// The contact point as seen from one collider. @param from_first that collider is the first of the
/// point's pair
SurfacePoint surfacePoint(const btManifoldPoint& point, bool from_first) {
  if (from_first) return {point.m_positionWorldOnB, point.m_normalWorldOnB, point.m_distance1};
  return {point.m_positionWorldOnA, -point.m_normalWorldOnB, point.m_distance1};
}

/// True when a point lies on an edge that is flush with the face of a nearer point beside it.
bool isInnerEdge(const SurfacePoint& edge, const SurfacePoint& face) {
  const btVector3 away_m = edge.at_m - face.at_m;
  const double cosine = face.normal.dot(edge.normal);
  return face.gap_m < edge.gap_m && away_m.length2() < kBeside_m * kBeside_m &&
         std::abs(face.normal.dot(away_m)) < kFlush_m && cosine > kOneSurface && cosine < kSame;
}

/// Removes inner edges from `at`, the manifold of a collider with one piece; `beside` is its
/// manifold with another piece. A collider that slides from one piece to the other keeps its
/// impulses and its friction anchor.
void removeEdges(btPersistentManifold& at, btPersistentManifold& beside,
                 const btCollisionObject& of) {
  const bool first_at = at.getBody0() == &of, first_beside = beside.getBody0() == &of;
  for (int i = at.getNumContacts(); i-- > 0;) {
    const btManifoldPoint& edge = at.getContactPoint(i);
    for (int j = 0; j < beside.getNumContacts(); ++j) {
      btManifoldPoint& face = beside.getContactPoint(j);
      if (!isInnerEdge(surfacePoint(edge, first_at), surfacePoint(face, first_beside))) continue;
      const bool takes = edge.m_appliedImpulse > face.m_appliedImpulse;
      if (takes && first_at == first_beside) inherit(face, edge);
      at.removeContactPoint(i);
      break;
    }
  }
}

/// Largest speed of a collider's surface due to the rotation of its body [m/s].
double turningSpeed(const BulletBody::Collider& of) {
  const bool ball = of.form.isRound() && of.form.kind().length_key == nullptr;
  // A sphere that rotates about its own centre.
  if (ball && of.in_rigid.getOrigin().fuzzyZero()) return 0.0;
  const double turn_rad_s = of.tag.rigid->getAngularVelocity().length();
  if (turn_rad_s == 0.0) return 0.0;
  const Eigen::Vector3d middle_m = 0.5 * (of.box.low_m + of.box.high_m);
  const double off_m = (middle_m - toEigen(of.tag.rigid->getCenterOfMassPosition())).norm();
  return turn_rad_s * (ball ? off_m : off_m + 0.5 * (of.box.high_m - of.box.low_m).norm());
}

}  // namespace

ColliderPairs::ColliderPairs(btCollisionDispatcher& dispatcher, BulletHand& hand,
                             std::vector<BulletBody>& bodies, RestingBodies& resting,
                             double threshold_m)
    : dispatcher_(dispatcher),
      hand_(hand),
      threshold_m_(threshold_m),
      resting_(resting),
      owner_(ownersOf(bodies)),
      is_around_(owner_.size()),
      sweep_(owner_, mostPairs(owner_.size())),
      parts_(owner_.size()) {
  for (const BulletBody& body : bodies) {
    const auto first = static_cast<int>(targets_.size());
    for (const auto& collider : body.colliders()) {
      Target& target = targets_.emplace_back();
      target.collider = collider.get();
      for (int c = 0; c < hand.count(); ++c) {
        if (meetsHand(collider->meets, hand.isPalm(c))) target.capsules.push_back(c);
      }
      target.pairs.resize(target.capsules.size());
      boxes_.push_back(collider->box);
      meets_bodies_.push_back(meetsBodies(collider->meets));
    }
    of_body_.emplace_back(first, static_cast<int>(targets_.size()));
  }
  const std::size_t most = mostPairs(targets_.size());
  for (std::vector<BodyPair>* list : {&body_pairs_, &before_}) list->reserve(most);
  near_.reserve(most);
  met_.reserve(2 * most);
  around_colliders_.reserve(targets_.size());
  touched_.reserve(kMostPieces);
}

ColliderPairs::~ColliderPairs() {
  for (Target& target : targets_) {
    for (Pair& pair : target.pairs) drop(pair);
  }
  for (BodyPair& pair : body_pairs_) drop(pair.pair);
}

bool ColliderPairs::awake(int collider) const noexcept {
  return resting_.awake(owner_[collider]);
}

void ColliderPairs::moved(int body) noexcept {
  for (int c = of_body_[body].first; c < of_body_[body].second; ++c) {
    boxes_[c] = targets_[c].collider->box;
    if (!is_around_[c] && overlap(around_, boxes_[c])) around_listed_ = false;
  }
}

void ColliderPairs::forget(int body) noexcept {
  for (int c = of_body_[body].first; c < of_body_[body].second; ++c) {
    for (Pair& pair : targets_[c].pairs) drop(pair);
    targets_[c].kept = 0;
  }
  std::erase_if(body_pairs_, [&](BodyPair& both) {
    if (owner_[both.a] != body && owner_[both.b] != body) return false;
    drop(both.pair);
    return true;
  });
  moved(body);
}

void ColliderPairs::refreshBoxes() noexcept {
  for (const int body : resting_.awakeBodies()) moved(body);
}

/// Lists the colliders that the hand may meet before it leaves around_, and those with kept pairs.
void ColliderPairs::listAround() noexcept {
  if (around_listed_ && contains(around_, hand_.box())) return;
  around_listed_ = true;
  around_.low_m = hand_.box().low_m.array() - kAround_m;
  around_.high_m = hand_.box().high_m.array() + kAround_m;
  around_colliders_.clear();
  for (std::size_t i = 0; i < targets_.size(); ++i) {
    is_around_[i] = targets_[i].kept > 0 || overlap(around_, boxes_[i]);
    if (is_around_[i]) around_colliders_.push_back(static_cast<int>(i));
  }
}

void ColliderPairs::find(double step_s) noexcept {
  step_s_ = step_s;
  refreshBoxes();
  listAround();
  for (const int c : around_colliders_) {
    if (targets_[c].kept > 0 || overlap(hand_.box(), boxes_[c])) findOfHand(targets_[c]);
  }
  removeInnerEdges();
  findOfBodies(step_s);
}

/// Removes inner edges, so that an edge between flush pieces of one surface (of one body or of
/// fixed bodies) does not stop a capsule that slides from one piece to the next.
void ColliderPairs::removeInnerEdges() noexcept {
  touched_.clear();
  for (const int c : around_colliders_) {
    if (touched_.size() == kMostPieces) break;
    if (targets_[c].kept > 0) touched_.push_back(c);
  }
  for (const int c : touched_) {
    const Target& at = targets_[c];
    for (std::size_t i = 0; i < at.capsules.size(); ++i) {
      if (at.pairs[i] == nullptr) continue;
      for (const int d : touched_) {
        if (c == d || !ofOneSurface(c, d)) continue;
        const Pair beside = targets_[d].pairWith(at.capsules[i]);
        if (beside != nullptr) removeEdges(*at.pairs[i], *beside, hand_.object(at.capsules[i]));
      }
    }
  }
}

ColliderPairs::Pair ColliderPairs::Target::pairWith(int capsule) const noexcept {
  const auto found = std::lower_bound(capsules.begin(), capsules.end(), capsule);
  if (found == capsules.end() || *found != capsule) return nullptr;
  return pairs[found - capsules.begin()];
}

bool ColliderPairs::ofOneSurface(int a, int b) const noexcept {
  const auto fixed = [&](int c) { return targets_[c].collider->tag.rigid->getInvMass() == 0.0; };
  const auto flat = [&](int c) { return targets_[c].collider->form.isPolyhedron(); };
  return owner_[a] == owner_[b] || (fixed(a) && fixed(b)) || (flat(a) && flat(b));
}

/// Removes inner edges for bodies that roll or slide from one piece to the next: compares each
/// collider with all pieces that it touches.
void ColliderPairs::removeInnerEdgesOfBodies() noexcept {
  if (resting_.awakeBodies().empty()) return;
  met_.clear();
  const auto piece = [&](int c) {
    const Collider& is = *targets_[c].collider;
    const auto [first, last] = of_body_[owner_[c]];
    return last - first > 1 || is.tag.rigid->getInvMass() == 0.0 || is.form.isPolyhedron();
  };
  for (std::size_t i = 0; i < body_pairs_.size(); ++i) {
    const BodyPair& both = body_pairs_[i];
    if (both.pair == nullptr || (!awake(both.a) && !awake(both.b))) continue;
    if (piece(both.b)) met_.push_back({both.a, both.b, both.pair});
    if (piece(both.a)) met_.push_back({both.b, both.a, both.pair});
  }
  std::sort(met_.begin(), met_.end(), [](const BodyPair& a, const BodyPair& b) {
    return std::pair(a.a, a.b) < std::pair(b.a, b.b);
  });
  for (std::size_t first = 0, last = 0; first < met_.size(); first = last) {
    while (last < met_.size() && met_[last].a == met_[first].a) ++last;
    const std::size_t end = std::min(last, first + kMostPieces);
    for (std::size_t i = first; i < end; ++i) {
      for (std::size_t j = first; j < end; ++j) {
        if (i == j || !ofOneSurface(met_[i].b, met_[j].b)) continue;
        removeEdges(*met_[i].pair, *met_[j].pair, *targets_[met_[i].a].collider->object);
      }
    }
  }
}

void ColliderPairs::findOfBodies(double step_s) noexcept {
  step_s_ = step_s;
  refreshBoxes();
  disturbNear();
  listOverlaps();
  follow();
  removeInnerEdgesOfBodies();
}

void ColliderPairs::placed(int body) noexcept {
  resting_.disturb(body);
  for (const BodyPair& both : body_pairs_) {
    const int a = owner_[both.a], b = owner_[both.b];
    if (a == body) resting_.disturb(b);
    if (b == body) resting_.disturb(a);
  }
  moved(body);
  for (int c = of_body_[body].first; c < of_body_[body].second; ++c) {
    if (!meets_bodies_[c]) continue;
    for (std::size_t k = 0; k < boxes_.size(); ++k) {
      if (meets_bodies_[k] && overlap(boxes_[c], boxes_[k])) {
        resting_.disturb(owner_[k]);
      }
    }
  }
}

/// Wakes resting bodies near awake ones.
void ColliderPairs::disturbNear() noexcept {
  if (resting_.awakeBodies().empty()) return;
  WorldBox all;
  for (const int body : resting_.awakeBodies()) {
    for (int c = of_body_[body].first; c < of_body_[body].second; ++c) {
      all.low_m = all.low_m.cwiseMin(boxes_[c].low_m);
      all.high_m = all.high_m.cwiseMax(boxes_[c].high_m);
    }
  }
  for (std::size_t k = 0; k < boxes_.size(); ++k) {
    const int other = owner_[k];
    if (!resting_.rests(other) || !meets_bodies_[k] || !overlap(all, boxes_[k])) continue;
    bool near = false;
    for (const int body : resting_.awakeBodies()) {
      for (int c = of_body_[body].first; c < of_body_[body].second && !near; ++c) {
        near = meets_bodies_[c] && overlap(boxes_[c], boxes_[k]);
      }
      if (near) break;
    }
    if (near) resting_.disturb(other);
  }
}

/// Lists overlapping pairs of which at least one collider is awake.
void ColliderPairs::listOverlaps() noexcept {
  if (parts_version_ != resting_.version()) {
    parts_version_ = resting_.version();
    for (std::size_t c = 0; c < parts_.size(); ++c) parts_[c] = partOf(static_cast<int>(c));
  }
  if (resting_.awakeBodies().empty()) {
    sweep_.clear();
  } else {
    sweep_.find(boxes_, parts_);
  }
  dropped_ = sweep_.dropped();
}

BoxSweep::Part ColliderPairs::partOf(int collider) const noexcept {
  if (!meets_bodies_[collider]) return BoxSweep::Part::kNone;
  if (awake(collider)) return BoxSweep::Part::kAwake;
  return resting_.rests(owner_[collider]) ? BoxSweep::Part::kRests : BoxSweep::Part::kStands;
}

/// Updates the contact points of overlapping pairs and removes pairs that no longer overlap. Pairs
/// of two resting bodies stay unchanged.
void ColliderPairs::follow() noexcept {
  const std::vector<BoxSweep::Pair>& overlaps = sweep_.pairs();
  if (overlaps.empty() && resting_.awakeBodies().empty()) return;
  std::swap(before_, body_pairs_);
  body_pairs_.clear();
  std::size_t now = 0;
  const auto take = [&](Pair pair) noexcept {
    const auto [a, b] = overlaps[now++];
    if (body_pairs_.size() == body_pairs_.capacity()) {
      ++dropped_;
      drop(pair);
      return;
    }
    meet(*targets_[a].collider, *targets_[b].collider, pair);
    body_pairs_.push_back({a, b, pair});
  };
  // Merges the old pairs with the present overlaps; both are ascending.
  for (BodyPair& old : before_) {
    const std::pair<int, int> both{old.a, old.b};
    while (now < overlaps.size() && overlaps[now] < both) take({});
    const bool still = now < overlaps.size() && overlaps[now] == both;
    if (still) {
      take(old.pair);
    } else if (awake(old.a) || awake(old.b) || body_pairs_.size() == body_pairs_.capacity()) {
      drop(old.pair);
    } else {
      body_pairs_.push_back(old);
    }
  }
  while (now < overlaps.size()) take({});
}

const std::vector<RestingBodies::Near>& ColliderPairs::near() noexcept {
  near_.clear();
  for (const BodyPair& both : body_pairs_) {
    near_.emplace_back(owner_[both.a], owner_[both.b]);
  }
  return near_;
}

void ColliderPairs::findOfHand(Target& target) noexcept {
  Collider& collider = *target.collider;
  target.kept = 0;
  for (std::size_t i = 0; i < target.capsules.size(); ++i) {
    const int capsule = target.capsules[i];
    Pair& pair = target.pairs[i];
    if (!overlap(hand_.placed(capsule).box, collider.box)) {
      drop(pair);
      continue;
    }
    resting_.disturb(collider.tag.body);
    const double reach_m = reach(collider, nullptr);
    const PlacedCapsule& placed = hand_.placed(capsule);
    const ContactPatch patch =
        collider.tag.shape != nullptr
            ? patchOf({placed.a_m, placed.b_m, placed.radius_m}, collider, reach_m)
            : findPatch(hand_.object(capsule), hand_.form(capsule), *collider.object, collider.form,
                        reach_m, pair);
    if (pair != nullptr && passedThrough(*pair, patch)) {
      pair->refreshContactPoints(hand_.object(capsule).getWorldTransform(),
                                 collider.object->getWorldTransform());
      if (pair->getNumContacts() == 0) drop(pair);
    } else if (patch.count > 0 || pair != nullptr) {
      keep(patch, hand_.object(capsule), *collider.object, pair);
    }
    if (pair != nullptr) ++target.kept;
  }
}

/// Contact of a sphere-swept segment (capsule of the hand, or sphere) with a shape that has a
/// closed-form distance: the nearest point, and also the ends of the segment if they touch.
ContactPatch ColliderPairs::patchOf(const Round& round, const Collider& collider,
                                    double reach_m) noexcept {
  const btTransform& frame = collider.object->getWorldTransform();
  const Eigen::Vector3d a_m = toEigen(frame.invXform(toBt(round.a_m)));
  const Eigen::Vector3d b_m = toEigen(frame.invXform(toBt(round.b_m)));
  ContactPatch patch;
  const auto add = [&](const SegmentDistance& is, const Eigen::Vector3d& on_axis_m) {
    if (is.distance_m > reach_m) return;
    const btVector3 normal = frame.getBasis() * toBt(is.normal);
    patch.add({frame * toBt(on_axis_m) - normal * (is.distance_m + round.radius_m), normal,
               is.distance_m});
  };
  const SegmentDistance is =
      contactDistance(*collider.tag.shape, a_m, b_m, round.radius_m, reach_m);
  add(is, a_m + is.along * (b_m - a_m));
  if (patch.count == 0) return patch;
  const double length_m = (b_m - a_m).norm();
  for (const double end : {0.0, 1.0}) {
    if (std::abs(end - is.along) * length_m < kApart_m) continue;
    const Eigen::Vector3d at_m = end == 0.0 ? a_m : b_m;
    add(contactDistance(*collider.tag.shape, at_m, at_m, round.radius_m, reach_m), at_m);
  }
  return patch;
}

ColliderPairs::Round ColliderPairs::roundOf(const btCollisionObject& object,
                                            const Shape& form) noexcept {
  const btTransform& at = object.getWorldTransform();
  const btVector3 half_m = at.getBasis().getColumn(2) * (0.5 * form.length_m);
  return {toEigen(at.getOrigin() - half_m), toEigen(at.getOrigin() + half_m), form.radius_m};
}

/// Largest gap of a contact point: includes the distance by which two bodies may approach in a step
/// [m].
double ColliderPairs::reach(const Collider& a, const Collider* b) const noexcept {
  btVector3 velocity = a.tag.rigid->getLinearVelocity();
  double turning_m_s = turningSpeed(a);
  if (b != nullptr) {
    velocity -= b->tag.rigid->getLinearVelocity();
    turning_m_s += turningSpeed(*b);
  }
  return threshold_m_ + (velocity.length() + turning_m_s) * step_s_;
}

void ColliderPairs::meet(Collider& a, Collider& b, Pair& pair) noexcept {
  if (passes(*a.tag.rigid, *b.tag.rigid)) return drop(pair);
  const double reach_m = reach(a, &b);
  const bool closed_form = a.tag.shape != nullptr && b.tag.shape != nullptr;
  if (closed_form && (a.form.isRound() || b.form.isRound())) {
    Collider& round = a.form.isRound() ? a : b;
    Collider& other = a.form.isRound() ? b : a;
    return keep(patchOf(roundOf(*round.object, round.form), other, reach_m), *round.object,
                *other.object, pair);
  }
  keep(findPatch(*a.object, a.form, *b.object, b.form, reach_m, pair), *a.object, *b.object, pair);
}

void ColliderPairs::keep(const ContactPatch& patch, const btCollisionObject& first,
                         const btCollisionObject& second, Pair& pair) noexcept {
  if (patch.count == 0) return drop(pair);
  if (pair == nullptr) {
    pair = dispatcher_.getNewManifold(&first, &second);
    ++version_;
  }
  renew(*pair, patch);
}

void ColliderPairs::drop(Pair& pair) noexcept {
  if (pair == nullptr) return;
  ++version_;
  dispatcher_.releaseManifold(pair);
  pair = nullptr;
}

}  // namespace wholehand::bullet
