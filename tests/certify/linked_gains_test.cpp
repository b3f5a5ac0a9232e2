// Random gains of several axes that satisfy the coupled criterion, simulated in time with random
// persons and objects whose full matrices link the axes: none becomes unstable. The person's side
// is the simulated device's own (loop/device/simulated/linked_dynamics.hpp). The same for persons
// and objects that change from tick to tick, with gains that hold for any person.
#include "certified_sets.hpp"
#include "certify/passivity.hpp"
#include "certify/stability.hpp"
#include "loop/device/simulated/linked_dynamics.hpp"
#include "support/constants.hpp"
#include "support/figure.hpp"

#include <Eigen/LU>

#include <deque>
#include <optional>

namespace wholehand::test {
namespace {

using Matrix = Eigen::MatrixXd;
using Vector = Eigen::VectorXd;

constexpr int kLinkedTicks = 2000;

double spread(Draw& draw, double low, double high) {
  return low + (high - low) * draw.unit();
}

/// Positive semidefinite, of random rank from 1 on and of about that size.
Matrix semidefinite(Draw& draw, int n, double size) {
  const Matrix a =
      Matrix::NullaryExpr(n, 1 + draw.upTo(n - 1), [&draw] { return spread(draw, -1.0, 1.0); });
  return size * a * a.transpose();
}
Matrix sometimes(Draw& draw, int n, double low, double high) {
  return draw.chance(0.4) ? Matrix::Zero(n, n) : semidefinite(draw, n, draw.between(low, high));
}

/// Random γ, filters, delays, walls and armature (σ is 1 on every axis by the law), with slightly
/// more damping than the coupled criterion requires. @return nullopt where no damping is enough
std::optional<CoupledCase> linkedSet(Draw& draw, double more, Persons persons = Persons::kLinear) {
  const int n = 2 + draw.upTo(2);
  CoupledCase c;
  c.persons = persons;
  c.delay_ticks = draw.upTo(3);
  c.period_s = kPeriod_s;
  AxisMatrix inertia = AxisMatrix::Zero(n, n);
  for (int i = 0; i < n; ++i) {
    AxisCase a;
    a.axis.mass = draw.between(0.2, 3.0);
    a.axis.damping = draw.between(0.5, 2.0);
    a.delay_ticks = c.delay_ticks;
    a.period_s = kPeriod_s;
    a.gains.k_pm = draw.between(100.0, 3000.0);
    a.gains.k_dm = draw.chance(0.2) ? 0.0 : spread(draw, 0.5, 15.0);
    a.gains.gamma = draw.chance(0.15) ? 0.0 : draw.unit();
    a.gains.velocity_filter_hz = draw.between(15.0, 100.0);
    a.inertia = a.gains.k_pm / draw.between(500.0, 2e4);
    if (draw.chance(0.3)) a.walls = {{draw.between(0.05, 0.5) * a.gains.k_pm, draw.unit()}};
    inertia(i, i) = a.inertia;
    c.axes.push_back(a);
  }
  for (int i = 0; i < n; ++i) {
    for (int k = 0; k < i; ++k) {
      inertia(i, k) = inertia(k, i) =
          spread(draw, -0.4, 0.4) * std::sqrt(inertia(i, i) * inertia(k, k));
    }
  }
  c.inertias = {inertia};
  const double share = requiredShare(c).share;
  if (!(share < 1e3)) return std::nullopt;
  for (AxisCase& a : c.axes) a.axis.damping *= more * std::max(share, 0.01);
  return c;
}

/// Device and person, loop, avatar and object, tick by tick.
class LinkedLoop {
 public:
  LinkedLoop(const CoupledCase& c, Draw& draw)
      : c_(c), n_(static_cast<int>(c.axes.size())), phi_(draw.chance(0.3) ? 0.0 : draw.unit()) {
    plant_ = {semidefinite(draw, n_, draw.between(0.01, 10.0)),
              sometimes(draw, n_, 0.1, 30.0),
              sometimes(draw, n_, 1.0, 1e4),
              AxisEffort(n_),
              AxisPosition(n_, -1e3),
              AxisPosition(n_, 1e3)};
    AxisStiffness k_pm(n_);
    for (int i = 0; i < n_; ++i) {
      const AxisCase& a = c.axes[i];
      plant_.mass(i, i) += a.axis.mass;
      plant_.damping(i, i) += a.axis.damping;
      if (draw.chance(0.3)) plant_.coulomb[i] = spread(draw, 0.0, 0.3);
      k_pm[i] = a.gains.k_pm;
    }
    damping_ = avatarDamping(c.inertias[0], k_pm, kPeriod_s);
    const double size = c.inertias[0].diagonal().mean();
    inertia_ = Matrix(c.inertias[0]) + sometimes(draw, n_, 0.1 * size, 100.0 * size);
    spring_ = sometimes(draw, n_, 10.0, 1e6);
    free_ =
        (inertia_ + kPeriod_s * sometimes(draw, n_, 0.1, 100.0) + kPeriod_s * kPeriod_s * spring_)
            .inverse();
    person_.emplace(plant_, kPeriod_s);
    x_ = before_ = Vector::NullaryExpr(n_, [&] { return spread(draw, -0.05, 0.05); });
    v_ = Vector::NullaryExpr(n_, [&] { return spread(draw, -1.5, 1.5); });
    xs_ = vs_ = filtered_ = Vector::Zero(n_);
    AxisPosition q(n_);
    AxisVelocity qd(n_);
    q.vec() = x_;
    qd.vec() = v_;
    person_->place(q, qd);
    queue_.assign(static_cast<std::size_t>(c.delay_ticks), AxisEffort(n_));
    wall_at_ = Vector::NullaryExpr(n_, [&] { return spread(draw, -0.01, 0.01); });
  }

  void tick() {
    AxisEffort f(n_);
    Vector drive(n_);
    for (int i = 0; i < n_; ++i) {
      const AxisCase& a = c_.axes[i];
      const double tau_s = 1.0 / (2.0 * std::numbers::pi * a.gains.velocity_filter_hz);
      const double d = damping_[i];
      filtered_[i] = (tau_s * filtered_[i] + x_[i] - before_[i]) / (tau_s + kPeriod_s);
      f[i] = a.gains.k_pm * (xs_[i] - x_[i]) + a.gains.gamma * d * (vs_[i] - filtered_[i]) -
             phi_ * a.gains.k_dm * filtered_[i];
      if (const double depth = depthOf(i); depth > 0.0) {
        const WallCase& wall = a.walls.front();
        f[i] -= std::max(0.0, wall.stiffness * depth + wall.damping * filtered_[i]);
      }
      drive[i] = a.gains.k_pm * (x_[i] - xs_[i]) + d * (filtered_[i] - vs_[i]);
    }
    before_ = x_;
    queue_.push_back(f);
    person_->advance(queue_.front(), queue_.front());
    queue_.pop_front();
    for (int i = 0; i < n_; ++i) {
      x_[i] = person_->position(i);
      v_[i] = person_->velocity(i);
    }
    vs_ = free_ * (inertia_ * vs_ + kPeriod_s * (drive - spring_ * xs_));
    xs_ += kPeriod_s * vs_;
  }

  /// Energy of everything that moves or is stretched [J].
  [[nodiscard]] double energy() const {
    double sum = v_.dot(plant_.mass * v_) + x_.dot(plant_.stiffness * x_) +
                 vs_.dot(inertia_ * vs_) + xs_.dot(spring_ * xs_);
    for (int i = 0; i < n_; ++i) {
      const AxisCase& a = c_.axes[i];
      sum += a.gains.k_pm * (x_[i] - xs_[i]) * (x_[i] - xs_[i]);
      if (const double depth = depthOf(i); depth > 0.0) {
        sum += a.walls.front().stiffness * depth * depth;
      }
    }
    return 0.5 * sum;
  }

 private:
  [[nodiscard]] double depthOf(int i) const {
    return c_.axes[i].walls.empty() ? 0.0 : x_[i] - wall_at_[i];
  }

  CoupledCase c_;
  int n_;
  double phi_;
  LinkedPlant plant_;
  std::optional<LinkedDynamics> person_;
  AxisDamping damping_;
  Matrix inertia_, spring_, free_;
  Vector x_, v_, xs_, vs_, before_, filtered_, wall_at_;
  std::deque<AxisEffort> queue_;
};

/// A number that changes from tick to tick: at random, as a square wave of 2 to 200 ticks, or
/// never.
class Changing {
 public:
  Changing(Draw& draw, double low, double high)
      : low_(low), high_(high), ticks_(draw.between(2.0, 200.0)), kind_(draw.unit()) {
    now_ = spread(draw, low, high);
    at_ = ticks_ * draw.unit();
  }
  double next(Draw& draw) {
    if (kind_ < 0.3) now_ = spread(draw, low_, high_);
    if (kind_ > 0.6) now_ = std::fmod(++at_, ticks_) < 0.5 * ticks_ ? low_ : high_;
    return now_;
  }

 private:
  double low_, high_, ticks_, kind_, at_ = 0.0, now_ = 0.0;
};

/// A spring, a flywheel and a dashpot behind gears whose ratios change from tick to tick: passive
/// for any ratios, but neither linear nor time-invariant.
struct ChangingPart {
  ChangingPart(Draw& draw, int n, double stiffness, double mass, double damping)
      : stiffness(stiffness), mass(mass), damping(damping) {
    for (int i = 0; i < 3 * n; ++i) {
      ratios.emplace_back(draw, draw.chance(0.3) ? 0.0 : -1.0, draw.chance(0.3) ? 0.0 : 1.0);
    }
    spring_gear = wheel_gear = dashpot_gear = Vector::Zero(n);
  }
  void change(Draw& draw) {
    const auto n = static_cast<std::size_t>(spring_gear.size());
    for (std::size_t i = 0; i < n; ++i) {
      const auto to = static_cast<Eigen::Index>(i);
      spring_gear[to] = ratios[i].next(draw);
      wheel_gear[to] = ratios[n + i].next(draw);
      dashpot_gear[to] = ratios[2 * n + i].next(draw);
    }
  }
  [[nodiscard]] Matrix damper() const { return damping * dashpot_gear * dashpot_gear.transpose(); }
  [[nodiscard]] double energy() const {
    return 0.5 * (stiffness * stretch * stretch + mass * wheel * wheel);
  }

  double stiffness, mass, damping;
  double stretch = 0.0, wheel = 0.0;  ///< of the spring; speed of the flywheel
  Vector spring_gear, wheel_gear, dashpot_gear;
  std::vector<Changing> ratios;
};

/// The loop with device and person by the implicit midpoint rule, which keeps their energy in every
/// step, and implicit avatar and object. Φ, person and object change from tick to tick.
class ChangingLoop {
 public:
  ChangingLoop(const CoupledCase& c, Draw& draw)
      : c_(c),
        n_(static_cast<int>(c.axes.size())),
        draw_(draw),
        person_(draw, n_, draw.between(1.0, 1e4), 0.0,
                draw.chance(0.5) ? 0.0 : draw.between(0.1, 300.0)),
        object_(draw, n_, draw.between(10.0, 1e6),
                draw.between(0.1, 100.0) * c.inertias[0].diagonal().mean(),
                draw.chance(0.7) ? 0.0 : draw.between(0.1, 1e4)) {
    mass_ =
        draw.chance(0.3) ? Matrix::Zero(n_, n_) : semidefinite(draw, n_, draw.between(0.01, 10.0));
    damping_ = Matrix::Zero(n_, n_);
    AxisStiffness k_pm(n_);
    for (int i = 0; i < n_; ++i) {
      mass_(i, i) += c.axes[i].axis.mass;
      damping_(i, i) = c.axes[i].axis.damping;
      k_pm[i] = c.axes[i].gains.k_pm;
      phi_.emplace_back(draw, 0.0, 1.0);
    }
    avatar_damping_ = avatarDamping(c.inertias[0], k_pm, kPeriod_s);
    x_ = before_ = Vector::NullaryExpr(n_, [&] { return spread(draw, -0.05, 0.05); });
    v_ = Vector::NullaryExpr(n_, [&] { return spread(draw, -1.5, 1.5); });
    xs_ = vs_ = filtered_ = Vector::Zero(n_);
    queue_.assign(static_cast<std::size_t>(c.delay_ticks), Vector::Zero(n_));
  }

  void tick() {
    person_.change(draw_);
    object_.change(draw_);
    Vector f(n_), drive(n_);
    for (int i = 0; i < n_; ++i) {
      const AxisCase& a = c_.axes[i];
      const double tau_s = 1.0 / (2.0 * std::numbers::pi * a.gains.velocity_filter_hz);
      const double d = avatar_damping_[i];
      filtered_[i] = (tau_s * filtered_[i] + x_[i] - before_[i]) / (tau_s + kPeriod_s);
      f[i] = a.gains.k_pm * (xs_[i] - x_[i]) + a.gains.gamma * d * (vs_[i] - filtered_[i]) -
             phi_[i].next(draw_) * a.gains.k_dm * filtered_[i];
      if (!a.walls.empty()) {
        f[i] -= a.walls[0].stiffness * x_[i] + a.walls[0].damping * filtered_[i];
      }
      drive[i] = a.gains.k_pm * (x_[i] - xs_[i]) + d * (filtered_[i] - vs_[i]);
    }
    before_ = x_;
    queue_.push_back(f);
    movePerson(queue_.front());
    queue_.pop_front();
    moveAvatar(drive);
  }

  /// Energy of everything that moves or is stretched [J].
  [[nodiscard]] double energy() const {
    double sum = v_.dot(mass_ * v_) + vs_.dot(c_.inertias[0] * vs_);
    for (int i = 0; i < n_; ++i) {
      const AxisCase& a = c_.axes[i];
      sum += a.gains.k_pm * (x_[i] - xs_[i]) * (x_[i] - xs_[i]);
      if (!a.walls.empty()) sum += a.walls[0].stiffness * x_[i] * x_[i];
    }
    return 0.5 * sum + person_.energy() + object_.energy();
  }

 private:
  void movePerson(const Vector& f) {
    constexpr int kSteps = 4;
    const double h = kPeriod_s / kSteps;
    const Vector& gear = person_.spring_gear;
    const Matrix whole = 2.0 / h * mass_ + damping_ + person_.damper() +
                         0.5 * h * person_.stiffness * gear * gear.transpose();
    const Matrix inverse = whole.inverse();
    for (int k = 0; k < kSteps; ++k) {
      const Vector middle =
          inverse * (2.0 / h * mass_ * v_ + f - person_.stiffness * person_.stretch * gear);
      x_ += h * middle;
      v_ = 2.0 * middle - v_;
      person_.stretch += h * gear.dot(middle);
    }
  }

  void moveAvatar(const Vector& drive) {
    const Vector &gear = object_.spring_gear, &to_wheel = object_.wheel_gear;
    const Matrix inertia = c_.inertias[0];
    const Matrix whole = inertia + kPeriod_s * object_.damper() +
                         kPeriod_s * kPeriod_s * object_.stiffness * gear * gear.transpose() +
                         object_.mass * to_wheel * to_wheel.transpose();
    vs_ = whole.inverse() * (inertia * vs_ + object_.mass * object_.wheel * to_wheel +
                             kPeriod_s * (drive - object_.stiffness * object_.stretch * gear));
    xs_ += kPeriod_s * vs_;
    object_.stretch += kPeriod_s * gear.dot(vs_);
    if (!to_wheel.isZero())
      object_.wheel = to_wheel.dot(vs_);  // disengaged, the flywheel keeps turning
  }

  CoupledCase c_;
  int n_;
  Draw draw_;
  ChangingPart person_, object_;
  std::vector<Changing> phi_;
  Matrix mass_, damping_;
  AxisDamping avatar_damping_;
  Vector x_, v_, xs_, vs_, before_, filtered_;
  std::deque<Vector> queue_;
};

/// Largest energy of the second two seconds divided by that of the first two.
template <class Loop>
double growthOf(Loop loop) {
  double first = loop.energy(), second = 0.0;
  for (int k = 0; k < 2 * kLinkedTicks; ++k) {
    loop.tick();
    double& most = k < kLinkedTicks ? first : second;
    most = std::max(most, loop.energy());
    if (!(most < 1e9)) return HUGE_VAL;
  }
  return second / first;
}

TEST(LinkedGains, PersonsAndObjectsThatLinkTheAxes_AreStable) {
  Draw draw(74);
  int tried = 0, unstable = 0;
  double most = 0.0;
  for (int trial = 0; tried < cases(40); ++trial) {
    ASSERT_LT(trial, 3 * cases(40) + 30) << "hardly a set that can be certified";
    const double more = 1.002 + 0.5 * draw.unit() * draw.unit();
    const std::optional<CoupledCase> set = linkedSet(draw, more);
    if (!set) continue;
    const double growth = growthOf(LinkedLoop(*set, draw));
    ++tried;
    most = std::max(most, growth);
    if (growth <= 1.0) continue;
    ++unstable;
    ADD_FAILURE() << "set " << trial << " grows by " << growth;
  }
  figure("certified sets with linked persons and objects", tried, "sets");
  figure("largest energy of their second two seconds over the first", most, "");
  EXPECT_EQ(unstable, 0);
}

TEST(LinkedGains, PersonsAndObjectsThatChange_AreStable) {
  Draw draw(76);
  int tried = 0;
  double most = 0.0;
  for (int trial = 0; tried < cases(80); ++trial) {
    ASSERT_LT(trial, 3 * cases(80) + 30) << "hardly a set that can be certified";
    const double more = 1.002 + 0.5 * draw.unit() * draw.unit();
    const std::optional<CoupledCase> set = linkedSet(draw, more, Persons::kAny);
    if (!set) continue;
    const double growth = growthOf(ChangingLoop(*set, draw));
    ++tried;
    most = std::max(most, growth);
    EXPECT_LE(growth, 1.0) << "set " << trial;
  }
  figure("sets certified for any person, with persons, objects and Φ that change", tried, "sets");
  figure("largest energy of their second two seconds over the first", most, "");
}

/// The test can fail: changing parts mostly dissipate, so it takes additional delay.
TEST(LinkedGains, TooLittleDampingAndFiveMoreTicksOfDelay_IsDetectedWithChangingParts) {
  Draw draw(77);
  int grew = 0;
  for (int trial = 0; trial < 200; ++trial) {
    std::optional<CoupledCase> set = linkedSet(draw, 1e-3, Persons::kAny);
    if (!set) continue;
    set->delay_ticks += 5;
    if (growthOf(ChangingLoop(*set, draw)) > 1.0) ++grew;
  }
  figure("of 200 sets with a thousandth of the damping and 5 ticks more delay grow", grew, "");
  EXPECT_GT(grew, 0);
}

/// The test can fail: with a thousandth of the damping some loops grow.
TEST(LinkedGains, FarTooLittleDamping_IsDetected) {
  Draw draw(75);
  int grew = 0;
  for (int trial = 0; trial < 200; ++trial) {
    const std::optional<CoupledCase> set = linkedSet(draw, 1e-3);
    if (set && growthOf(LinkedLoop(*set, draw)) > 1.0) ++grew;
  }
  figure("of 200 sets with a thousandth of the damping grow", grew, "");
  EXPECT_GT(grew, 0);
}

}  // namespace
}  // namespace wholehand::test
