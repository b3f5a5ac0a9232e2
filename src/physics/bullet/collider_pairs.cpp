#include "physics/bullet/collider_pairs.hpp"

#include "physics/bullet/bullet_types.hpp"
#include "physics/segment_distance.hpp"

#include <BulletCollision/BroadphaseCollision/btCollisionAlgorithm.h>
#include <BulletCollision/CollisionDispatch/btCollisionObjectWrapper.h>
#include <BulletCollision/CollisionDispatch/btManifoldResult.h>

#include <algorithm>
#include <utility>

namespace wholehand::bullet {
namespace {

constexpr double kAround_m = 0.03;  // 30 ms of a fast hand

bool meetsHand(BulletBody::Meets meets, bool palm) {
  return meets == BulletBody::Meets::kAll || (meets == BulletBody::Meets::kDigits) == !palm;
}

bool meetsBodies(BulletBody::Meets meets) {
  return meets != BulletBody::Meets::kDigits;
}

/// Room for the pairs of bodies that overlap at once: all of a small scene, more than lie around
/// one another in a large one.
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

bool keeps(const btPersistentManifold* manifold) {
  return manifold != nullptr && manifold->getNumContacts() > 0;
}

bool isBall(const BulletBody::Collider& collider) {
  return collider.form.type == ShapeType::kSphere;
}

btCollisionObjectWrapper wrap(btCollisionObject& object) {
  return {nullptr, object.getCollisionShape(), &object, object.getWorldTransform(), -1, -1};
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
  around_colliders_.reserve(targets_.size());
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

void ColliderPairs::find() noexcept {
  refreshBoxes();
  listAround();
  for (const int c : around_colliders_) {
    if (targets_[c].kept > 0 || overlap(hand_.box(), boxes_[c])) findOfHand(targets_[c]);
  }
  findOfBodies();
}

void ColliderPairs::findOfBodies() noexcept {
  refreshBoxes();
  disturbNear();
  listOverlaps();
  follow();
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
    if (collider.tag.shape != nullptr) {
      const PlacedCapsule& placed = hand_.placed(capsule);
      touch(
          {placed.a_m, placed.b_m, placed.radius_m},
          [this, capsule]() -> btCollisionObject& { return hand_.object(capsule); }, collider,
          pair);
    } else {
      ask(pair, hand_.object(capsule), *collider.object);
    }
    if (pair.manifold != nullptr || pair.algorithm != nullptr) ++target.kept;
  }
}

/// Contact of a sphere-swept segment (capsule of the hand, or ball) with a shape that has a
/// closed-form distance. @param object returns Bullet's object of the segment
template <class Object>
void ColliderPairs::touch(const Round& round, const Object& object, Collider& collider,
                          Pair& pair) noexcept {
  const btTransform& frame = collider.object->getWorldTransform();
  const SegmentDistance is =
      contactDistance(*collider.tag.shape, toEigen(frame.invXform(toBt(round.a_m))),
                      toEigen(frame.invXform(toBt(round.b_m))), round.radius_m, threshold_m_);
  const bool near = is.distance_m <= threshold_m_;
  if (!near && pair.manifold == nullptr) return;
  btCollisionObject& first = object();
  const btCollisionObjectWrapper a = wrap(first), b = wrap(*collider.object);
  btManifoldResult points(&a, &b);
  if (pair.manifold == nullptr) {
    pair.manifold = dispatcher_.getNewManifold(&first, collider.object.get());
    ++version_;
  }
  points.setPersistentManifold(pair.manifold);
  if (near) {
    const Eigen::Vector3d on_axis_m = round.a_m + is.along * (round.b_m - round.a_m);
    const btVector3 normal = frame.getBasis() * toBt(is.normal);
    points.addContactPoint(normal, toBt(on_axis_m) - normal * (is.distance_m + round.radius_m),
                           is.distance_m);
  }
  points.refreshContactPoints();
  if (!near && !keeps(pair.manifold)) drop(pair);
}

void ColliderPairs::meet(Collider& a, Collider& b, Pair& pair) noexcept {
  const bool closed_form = a.tag.shape != nullptr && b.tag.shape != nullptr;
  const bool ball_a = isBall(a), ball_b = isBall(b);
  if (!closed_form || ball_a == ball_b) return ask(pair, *a.object, *b.object);
  Collider& ball = ball_a ? a : b;
  const Eigen::Vector3d at_m = toEigen(ball.object->getWorldTransform().getOrigin());
  touch(
      {at_m, at_m, ball.form.radius_m}, [&ball]() -> btCollisionObject& { return *ball.object; },
      ball_a ? b : a, pair);
}

/// Bullet's own narrow phase.
void ColliderPairs::ask(Pair& pair, btCollisionObject& first, btCollisionObject& second) noexcept {
  const btCollisionObjectWrapper a = wrap(first), b = wrap(second);
  if (pair.algorithm == nullptr) {
    ++version_;
    pair.algorithm = dispatcher_.findAlgorithm(&a, &b, nullptr, BT_CONTACT_POINT_ALGORITHMS);
  }
  btManifoldResult points(&a, &b);
  pair.algorithm->processCollision(&a, &b, info_, &points);
}

void ColliderPairs::drop(Pair& pair) noexcept {
  if (pair.manifold != nullptr || pair.algorithm != nullptr) ++version_;
  if (pair.manifold != nullptr) dispatcher_.releaseManifold(pair.manifold);
  if (pair.algorithm != nullptr) {
    pair.algorithm->~btCollisionAlgorithm();
    dispatcher_.freeCollisionAlgorithm(pair.algorithm);
  }
  pair = Pair{};
}

}  // namespace wholehand::bullet
