#include "certify/certificate.hpp"

#include "certify/passivity.hpp"
#include "certify/stability.hpp"
#include "loop/control/bilateral_coupling.hpp"
#include "loop/control/viscoelastic.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>

namespace wholehand {

namespace {

constexpr double kInfinite = std::numeric_limits<double>::infinity();
constexpr double kLargestFactor = 100.0;
/// The coupled criterion is at least as strict as the criteria of single axes. It counts as binding
/// when its margin is smaller by this factor.
constexpr double kBindingFactor = 0.995;
/// Lever arm assumed when the file names none: from the wrist to the middle of the palm.
constexpr double kPalmLever_m = 0.08;
constexpr std::array<const char*, 3> kPersons = {"no arm", "relaxed arm", "stiff arm"};
/// Masses of held objects relative to the avatar's inertia, and springs of touched objects relative
/// to the avatar's own stiffness.
constexpr std::array<double, 2> kHeldMasses = {1.0, 5.0};
constexpr std::array<double, 3> kSprings = {0.1, 1.0, 10.0};

/// Spectral radius of the loop in contact; `object` as in WorstRadius.
double radiusWith(AxisLoop loop, Criterion contact, double object) {
  if (contact == Criterion::kMass) loop.held_mass = object;
  if (contact == Criterion::kSpring) loop.spring_per_s2 = object * loop.k_ps_per_s2;
  const ContactCase touched = contact == Criterion::kFree    ? ContactCase::kFree
                              : contact == Criterion::kRigid ? ContactCase::kRigid
                                                             : ContactCase::kObject;
  return spectralRadius(closedLoopMatrix(loop, touched));
}

std::vector<double> objectsOf(Criterion contact) {
  if (contact == Criterion::kMass) return {kHeldMasses.begin(), kHeldMasses.end()};
  if (contact == Criterion::kSpring) return {kSprings.begin(), kSprings.end()};
  return {0.0};
}

/// Largest K_pm below which the contact is stable at every Φ. Searches upwards from a thousandth to
/// a thousand times the axis's own K_pm. No person is attached, because a passive arm only
/// stabilises.
double stiffnessLimit(const AxisCase& c, Criterion contact) {
  const auto stable = [&](double k_pm) {
    AxisCase tried = c;
    tried.gains.k_pm = k_pm;
    for (int i = 0; i <= kCertificatePhiSteps; ++i) {
      for (const double object : objectsOf(contact)) {
        const double phi = static_cast<double>(i) / kCertificatePhiSteps;
        if (!(radiusWith(tried.loop(phi), contact, object) <= 1.0 + 1e-7)) return false;
      }
    }
    return true;
  };
  double low = 1e-3 * c.gains.k_pm, high = low;
  if (!stable(low)) return 0.0;
  // 1.2^76 > 1e6; the steps are counted, because denormal numbers do not grow.
  constexpr int kSteps = 76;
  for (int i = 0; i < kSteps && stable(high); ++i) {
    low = high;
    high *= 1.2;
  }
  for (int i = 0; i < 25; ++i) {
    const double middle = 0.5 * (low + high);
    (stable(middle) ? low : high) = middle;
  }
  return low;
}

/// Margin of one criterion of an axis: allowed over present value.
double marginOf(const AxisCertificate& a, Criterion criterion) {
  const double k_pm = a.axis_case.gains.k_pm;
  switch (criterion) {
    case Criterion::kRigid:
      return a.rigid_limit / k_pm;
    case Criterion::kDamping:
      return a.damping_required > 0.0 ? a.axis_case.axis.damping / a.damping_required : kInfinite;
    case Criterion::kQuantisation:
      return a.quantisationLimit() / k_pm;
    case Criterion::kWall:
      return a.wall.margin;
    case Criterion::kSlew: {
      const double limit = a.axis_case.axis.effort_slew_limit;
      return limit > 0.0 ? limit / a.slew_required : kInfinite;
    }
    case Criterion::kCoupled:
      return kInfinite;
    case Criterion::kAvatar: {  // limit 1/T²: above it the avatar oscillates
      const double t = a.axis_case.period_s;
      const double wt = a.axis_case.avatarStiffness() * t * t;
      return wt <= 1.0 ? kInfinite : 1.0 / wt;
    }
    default:
      return a.meets(criterion) ? kInfinite : stiffnessLimit(a.axis_case, criterion) / k_pm;
  }
}

CoupledCertificate certifyCoupled(const CoupledCase& c) {
  const RequiredShare need = requiredShare(c);
  return {need.share > 0.0 ? 1.0 / need.share : kInfinite, need.frequency_hz, need.posture};
}

CoupledCase forAnyPerson(CoupledCase c) {
  c.persons = Persons::kAny;
  return c;
}

constexpr int kAlphaSteps = 4;

WorstRadius worstInWall(const AxisCase& c, const WallCase& wall) {
  WorstRadius worst;
  for (int share = 1; share <= kAlphaSteps; ++share) {
    const double alpha = static_cast<double>(share) / kAlphaSteps;
    for (int i = 0; i < kContactCriteria; ++i) {
      const WorstRadius found = worstContact(c, static_cast<Criterion>(i), wall, alpha);
      if (!(found.radius <= worst.radius)) worst = found;
    }
  }
  return worst;
}

}  // namespace

const char* criterionKey(Criterion criterion) {
  static constexpr std::array<const char*, 10> kKeys = {
      "free",         "rigid_contact", "mass", "spring", "damping",
      "quantisation", "wall",          "slew", "avatar", "coupled"};
  return kKeys[static_cast<std::size_t>(criterion)];
}

Impedance armAt(const DeviceAxis& axis, const std::string& person) {
  Impedance arm;
  if (person == kPersons[1]) arm = {1.0, 5.0, 100.0};
  if (person == kPersons[2]) arm = {1.5, 20.0, 600.0};
  if (axis.kind == AxisKind::kTranslation) return arm;
  const double lever_m = axis.lever_arm_m > 0.0 ? axis.lever_arm_m : kPalmLever_m;
  const double squared = lever_m * lever_m;
  return {arm.mass * squared, arm.damping * squared, arm.stiffness * squared};
}

double AxisCase::armature() const {
  return armatureOf(gains, inertia);
}

double AxisCase::avatarStiffness() const {
  return gains.k_pm / (inertia + armature());
}

AxisLoop AxisCase::loop(double phi) const {
  AxisLoop l;
  l.mass = axis.mass;
  l.damping = axis.damping;
  l.delay_ticks = delay_ticks;
  l.k_pm = gains.k_pm;
  l.phi_k_dm = phi * gains.k_dm;
  l.gamma = gains.gamma;
  l.k_ps_per_s2 = avatarStiffness();
  l.k_ds_per_s = criticalDamping(l.k_ps_per_s2, period_s);
  l.filter_tau_s = 1.0 / (2.0 * std::numbers::pi * gains.velocity_filter_hz);
  l.period_s = period_s;
  return l;
}

AxisLoop AxisCase::loopIn(const WallCase& wall, double alpha, double phi) const {
  AxisLoop l = loop(phi);
  l.wall_stiffness = alpha * wall.stiffness;
  l.wall_damping = alpha * wall.damping;
  l.wall_late = alpha * lateDamping(wall.stiffness, wall.resistance, delay_ticks, period_s);
  return l;
}

double quantisationLimit(const AxisCase& c) {
  const double viscous = 2.0 * c.axis.damping / c.period_s;
  const bool stated = c.axis.encoder_step > 0.0 && c.axis.coulomb > 0.0;
  return stated ? std::min(viscous, 2.0 * c.axis.coulomb / c.axis.encoder_step) : viscous;
}

double AxisCertificate::quantisationLimit() const {
  return std::min(viscous_limit, coulomb_limit);
}

bool AxisCertificate::meets(Criterion criterion) const {
  if (static_cast<int>(criterion) < kContactCriteria) {
    return contacts[static_cast<std::size_t>(criterion)].stable();
  }
  return marginOf(*this, criterion) >= 1.0;
}

AxisCase axisCase(const CertificateInput& input, int axis) {
  AxisCase c{input.device.axes[axis], input.device.output_delay_ticks, input.period_s,
             input.rendering.axes[axis], input.inertia_at_reference(axis, axis)};
  for (const CertificateInput::Wall& wall : input.walls) {
    if (wall.axis == axis) c.walls.push_back(wall.wall);
  }
  return c;
}

WorstRadius worstContact(const AxisCase& c, Criterion contact, const WallCase& wall, double alpha) {
  WorstRadius worst;
  for (const char* person : kPersons) {
    for (int i = 0; i <= kCertificatePhiSteps; ++i) {
      const double phi = static_cast<double>(i) / kCertificatePhiSteps;
      AxisLoop loop = c.loopIn(wall, alpha, phi);
      loop.person = armAt(c.axis, person);
      for (const double object : objectsOf(contact)) {
        const double radius = radiusWith(loop, contact, object);
        // A rigid drift has radius 1 in every case. The tolerance prevents that rounding selects
        // one of them.
        if (!(radius <= worst.radius + 1e-10)) worst = {radius, phi, person, alpha, object};
      }
    }
  }
  return worst;
}

AxisCertificate certifyAxis(const AxisCase& c) {
  AxisCertificate a;
  a.axis_case = c;
  a.rigid_formula = c.axis.damping / (c.period_s * (0.5 + c.delay_ticks));
  a.rigid_limit = stiffnessLimit(c, Criterion::kRigid);
  for (int i = 0; i < kContactCriteria; ++i) {
    a.contacts[i] = worstContact(c, static_cast<Criterion>(i));
  }
  const LargestDamping needed = largestRequiredDamping(c, {}, 0.0);
  a.damping_required = needed.damping;
  a.damping_required_phi = needed.phi;
  a.viscous_limit = 2.0 * c.axis.damping / c.period_s;
  const bool stated = c.axis.encoder_step > 0.0 && c.axis.coulomb > 0.0;
  a.coulomb_limit = stated ? 2.0 * c.axis.coulomb / c.axis.encoder_step : kInfinite;
  for (const WallCase& wall : c.walls) {
    const WallCertificate judged = certifyWall(c, wall);
    if (judged.margin < a.wall.margin) a.wall = judged;
  }
  a.slew_required = requiredSlew(c);
  a.passes = true;
  a.margin = kInfinite;
  // The axis passes if it meets all criteria; the one with the smallest margin binds.
  for (int i = 0; i <= static_cast<int>(Criterion::kAvatar); ++i) {
    const auto criterion = static_cast<Criterion>(i);
    a.passes = a.passes && a.meets(criterion);
    const double margin = marginOf(a, criterion);
    if (margin < a.margin) {
      a.margin = margin;
      a.binding = criterion;
    }
  }
  return a;
}

double Certificate::margin() const {
  if (binding_axis >= 0) {
    return std::min(axes[binding_axis].margin, coupled.margin);
  }
  return binding_criterion == Criterion::kAvatar ? avatar.margin : coupled.margin;
}

std::string Certificate::binding() const {
  if (binding_axis < 0) return criterionKey(binding_criterion);
  const AxisCertificate& a = axes[binding_axis];
  return a.axis_case.axis.name + "." + criterionKey(a.binding);
}

Certificate certify(const CertificateInput& input) {
  Certificate out;
  out.period_s = input.period_s;
  const int n = input.device.axisCount();
  AxisStiffness k_pm(n);
  for (int i = 0; i < n; ++i) {
    out.axes.push_back(certifyAxis(axisCase(input, i)));
    k_pm[i] = out.axes.back().axis_case.gains.k_pm;
  }
  const CoupledCase coupled = coupledCase(input);
  const std::vector<AxisMatrix> sampled(coupled.inertias.begin() + 1, coupled.inertias.end());
  const WorstPosture worst = worstPosture(sampled, k_pm, input.period_s);
  out.avatar = {worst.radius, -input.period_s / std::log(worst.radius), worst.posture,
                sampled.size(), largestStableFactor(sampled, k_pm, input.period_s, kLargestFactor)};
  out.coupled = certifyCoupled(coupled);
  out.any_person = certifyCoupled(forAnyPerson(coupled));
  out.certified = out.avatar.passes() && out.coupled.margin >= 1.0;
  // Finds the binding criterion: the smallest margin of the avatar and of the axes.
  double least = out.avatar.margin;
  for (int i = 0; i < n; ++i) {
    const AxisCertificate& a = out.axes[i];
    out.certified = out.certified && a.passes;
    if (a.margin < least) {
      least = a.margin;
      out.binding_axis = i;
      out.binding_criterion = a.binding;
    }
  }
  // The coupled criterion binds only where it is clearly stricter.
  if (out.avatar.passes() && out.coupled.margin < kBindingFactor * least) {
    out.binding_axis = -1;
    out.binding_criterion = Criterion::kCoupled;
  }
  return out;
}

LargestDamping largestRequiredDamping(const AxisCase& c, const WallCase& wall, double alpha) {
  LargestDamping most{-std::numeric_limits<double>::infinity(), 0.0};
  for (int i = 0; i <= kCertificatePhiSteps; ++i) {
    const double phi = static_cast<double>(i) / kCertificatePhiSteps;
    const double required = requiredDamping(c.loopIn(wall, alpha, phi));
    if (required > most.damping) most = {required, phi};
  }
  return most;
}

WallCertificate certifyWall(const AxisCase& c, const WallCase& wall) {
  WallCertificate out;
  out.wall = wall;
  const LargestDamping needed = largestRequiredDamping(c, wall, 1.0);
  out.damping_required = needed.damping;
  out.damping_required_phi = needed.phi;
  out.worst = worstInWall(c, wall);
  // Quantisation acts on the sum of coupling spring and wall spring.
  out.margin = quantisationLimit(c) / (c.gains.k_pm + wall.stiffness);
  if (needed.damping > 0.0) out.margin = std::min(out.margin, c.axis.damping / needed.damping);
  if (!out.worst.stable()) {
    const double share = largestAllowed(1.0, [&](double s) {
      return worstInWall(c, {s * wall.stiffness, s * wall.damping, wall.resistance}).stable();
    });
    out.margin = std::min(out.margin, share);
  }
  return out;
}

double requiredSlew(const AxisCase& c) {
  double most = 0.0;
  std::vector<WallCase> walls = c.walls;
  walls.push_back({});
  for (const WallCase& wall : walls) {
    const AxisLoop l = c.loopIn(wall, 1.0, 1.0);
    const double stiffness = l.k_pm + l.wall_stiffness;
    const double reciprocal = l.gamma * l.k_pm * l.k_ds_per_s / l.k_ps_per_s2;
    const double damping = reciprocal + l.phi_k_dm + l.wall_damping;
    const double rate_per_s = std::sqrt(stiffness / l.mass) + (damping + l.damping) / l.mass;
    most = std::max(most, c.axis.speed_limit * (stiffness + damping * rate_per_s));
  }
  return most;
}

namespace {

void add(std::string& text, double value) {
  text += fmt::format("{:.17g};", value);
}

std::string deviceText(const DeviceModel& device) {
  std::string text;
  add(text, device.output_delay_ticks);
  for (const DeviceAxis& a : device.axes) {
    text += a.kind == AxisKind::kTranslation ? 't' : 'r';
    for (const double value : {a.mass, a.damping, a.coulomb, a.encoder_step, a.lever_arm_m,
                               a.speed_limit, a.effort_slew_limit}) {
      add(text, value);
    }
  }
  return text;
}

std::string renderingText(const RenderingConfig& rendering) {
  std::string text;
  for (const AxisRendering& a : rendering.axes) {
    for (const double value :
         {a.k_pm, a.k_dm, a.gamma, a.velocity_filter_hz, a.armature.value_or(-1.0)}) {
      add(text, value);
    }
  }
  return text;
}

void addInertia(std::string& text, const AxisMatrix& m) {
  for (Eigen::Index i = 0; i < m.rows(); ++i) {
    text += fmt::format("{:.9g};", m(i, i));
    for (Eigen::Index j = 0; j < i; ++j) {
      // Entries are scaled by the diagonal, so that a zero entry with rounding errors is rounded to
      // zero on every machine.
      text += fmt::format("{};", std::llround(1e9 * m(i, j) / std::sqrt(m(i, i) * m(j, j))));
    }
  }
}

std::string exerciseName(const CertificateInput& input) {
  return input.level > 0 ? fmt::format("{} level {}", input.exercise, input.level) : input.exercise;
}

}  // namespace

std::string hashOf(const std::string& text) {
  std::uint64_t hash = 14695981039346656037U;
  for (const char c : text) hash = (hash ^ static_cast<unsigned char>(c)) * 1099511628211U;
  return fmt::format("{:016x}", hash);
}

CertificateFingerprint fingerprintOf(const CertificateInput& input) {
  std::string hand, walls;
  addInertia(hand, input.inertia_at_reference);
  for (const AxisMatrix& m : input.inertias) addInertia(hand, m);
  for (const CertificateInput::Wall& w : input.walls) {
    for (const double value :
         {static_cast<double>(w.axis), w.wall.stiffness, w.wall.damping, w.wall.resistance}) {
      add(walls, value);
    }
  }
  CertificateFingerprint out;
  out.rate_hz = 1.0 / input.period_s;
  out.parts = {{{input.device.name, hashOf(deviceText(input.device))},
                {input.rendering.name, hashOf(renderingText(input.rendering))},
                {input.hand, hashOf(hand)},
                {exerciseName(input), hashOf(walls)}}};
  return out;
}

std::string differenceOf(const CertificateFingerprint& certificate,
                         const CertificateFingerprint& run) {
  std::string out;
  const auto differs = [&out](const std::string& one, const std::string& other) {
    out += fmt::format("{}is for {}, this run {}", out.empty() ? "" : "; ", one, other);
  };
  if (certificate.version != run.version) {
    differs(fmt::format("criteria {}", certificate.version),
            fmt::format("goes by criteria {}", run.version));
  }
  if (std::abs(certificate.rate_hz - run.rate_hz) > 1e-9 * run.rate_hz) {
    differs(fmt::format("{:.6g} Hz", certificate.rate_hz),
            fmt::format("ticks at {:.6g} Hz", run.rate_hz));
  }
  const bool other_device = certificate.parts[0].hash != run.parts[0].hash;
  for (std::size_t i = 0; i < kFingerprintParts.size(); ++i) {
    const FingerprintPart &one = certificate.parts[i], &other = run.parts[i];
    if (one.hash == other.hash) continue;
    // On another device the same hand has another inertia and the same exercise has other walls, so
    // equal names do not count as a difference.
    if (i >= 2 && other_device && one.name == other.name) continue;
    const auto named = [](const std::string& name) { return name.empty() ? "none" : name; };
    if (one.name == other.name) {
      differs(fmt::format("other numbers of the {} {}", kFingerprintParts[i], named(one.name)),
              "has changed ones");
    } else {
      differs(fmt::format("the {} {}", kFingerprintParts[i], named(one.name)),
              fmt::format("uses {}", named(other.name)));
    }
  }
  return out;
}

}  // namespace wholehand
