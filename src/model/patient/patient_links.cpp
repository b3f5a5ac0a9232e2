#include "model/patient/patient_links.hpp"

#include "core/printable.hpp"
#include "model/patient/patient_keys.hpp"

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <array>
#include <cmath>

namespace wholehand {
namespace {

constexpr double kAnyLever_m = 1.0;  // axis of another device: its keys are still checked
constexpr double kRounding = 1e-12;  // of an eigenvalue, the diagonal being 1

std::string listOf(const std::vector<std::string>& names) {
  std::string out;
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (i > 0) out += i + 1 == names.size() ? " and " : ", ";
    out += names[i];
  }
  return out;
}

/// Reports an unknown or repeated name.
bool checkNames(TomlTable& table, const std::vector<std::string>& names,
                const DeviceModel& device) {
  std::vector<std::string> known;
  for (const DeviceAxis& axis : device.axes) known.push_back(axis.name);
  for (const KnownAxis& axis : kKnownAxes) known.emplace_back(axis.name);
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (std::find(known.begin(), known.end(), names[i]) == known.end()) {
      const std::string near = nearestUnused(names[i], known, names);
      table.fail("axes",
                 names[i] + " is neither an axis of the device " + printable(device.path) +
                     " nor a standard axis",
                 near.empty() ? "remove it" : "did you mean " + near + "?");
      return false;
    }
    if (std::count(names.begin(), names.end(), names[i]) > 1) {
      table.fail("axes", names[i] + " is listed twice", "list every axis once");
      return false;
    }
  }
  return true;
}

void readLevers(TomlTable& table, LinkedAxes& axes) {
  std::optional<TomlTable> levers = table.optionalTable("lever_m");
  if (!levers) return;
  for (const std::string& name : levers->keys()) {
    const auto at = std::find(axes.names.begin(), axes.names.end(), name);
    const auto i = at - axes.names.begin();
    if (at == axes.names.end() || axes.kinds[i] == AxisKind::kTranslation) {
      levers->fail(name, "is not a rotation among these axes", "remove it");
    } else {
      const double lever_m = levers->number(name, between(-1.0, 1.0, "m"));
      axes.lever_m[i] = levers->isGood(name) ? lever_m : kAnyLever_m;
    }
  }
}

bool every(const LinkedAxes& axes, AxisKind kind) {
  return std::all_of(axes.kinds.begin(), axes.kinds.end(), [&](AxisKind k) { return k == kind; });
}

/// Sum of one quantity over all links.
struct Sum {
  const AxisQuantity& quantity;
  AxisMatrix total;  ///< including the axes' own values on the diagonal
  /// Source of each part: the table and its key.
  struct Part {
    TomlTable table;
    std::string key;
    AxisMatrix matrix;
  };
  std::vector<Part> parts;
};

/// The matrix of one key, in the units of the axes, over all axes of the device.
AxisMatrix readMatrix(TomlTable& table, const LinkedAxes& axes, const AxisQuantity& quantity,
                      std::string_view key, int device_axes) {
  AxisMatrix out = AxisMatrix::Zero(device_axes, device_axes);
  const std::size_t n = axes.names.size();
  const NumberRule rule = between(-quantity.upper, quantity.upper, unitOfKey(key));
  const std::vector<double> values = table.matrix(key, n, rule);
  if (!table.isGood(key)) return out;
  const std::vector<double> factors = linkedFactors(axes, quantity, key);
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t k = 0; k < n; ++k) {
      const double there = values[i * n + k], mirrored = values[k * n + i];
      if (there != mirrored) {
        table.fail(key,
                   "is not symmetric: " + axes.names[i] + " to " + axes.names[k] + " is " +
                       formatNumber(there) + ", " + axes.names[k] + " to " + axes.names[i] +
                       " is " + formatNumber(mirrored),
                   "write the same number in both places");
        return AxisMatrix::Zero(device_axes, device_axes);
      }
      const int row = axes.on_device[i], column = axes.on_device[k];
      if (row >= 0 && column >= 0) out(row, column) = there * factors[i] * factors[k];
    }
  }
  return out;
}

/// Why a matrix is not positive semidefinite, and the remedy; empty if it is.
struct Refusal {
  std::string problem, remedy;
  Eigen::VectorXd direction;  ///< along which it is negative
};
std::optional<Refusal> indefinite(const AxisMatrix& m, const DeviceModel& device) {
  const Eigen::Index n = m.rows();
  const auto name = [&](Eigen::Index i) { return device.axes[i].name; };
  for (Eigen::Index i = 0; i < n; ++i) {
    const bool linked = (m.row(i).array() != 0.0).count() > (m(i, i) != 0.0 ? 1 : 0);
    if (m(i, i) > 0.0 || (m(i, i) == 0.0 && !linked)) continue;
    return Refusal{"is not positive semidefinite: with its own value " + name(i) + " has " +
                       formatNumber(m(i, i)) + " on the diagonal",
                   "give " + name(i) + " more on the diagonal, here or in its [[axes]]",
                   Eigen::VectorXd::Unit(n, i)};
  }
  // Scaled to a unit diagonal, so that units do not matter.
  Eigen::MatrixXd off = Eigen::MatrixXd::Zero(n, n);
  for (Eigen::Index i = 0; i < n; ++i) {
    for (Eigen::Index k = 0; k < n; ++k) {
      if (i != k && m(i, k) != 0.0) off(i, k) = m(i, k) / std::sqrt(m(i, i) * m(k, k));
    }
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(off);
  const double most = -solver.eigenvalues()[0];
  if (most <= 1.0 + kRounding * static_cast<double>(n)) return std::nullopt;
  Eigen::VectorXd along = solver.eigenvectors().col(0);
  std::vector<std::string> names;
  for (Eigen::Index i = 0; i < n; ++i) {
    if (std::abs(along[i]) > 0.1) names.push_back(name(i));
    if (m(i, i) > 0.0) along[i] /= std::sqrt(m(i, i));
  }
  const double share = std::floor(1000.0 / most) / 1000.0;
  return Refusal{
      "is not positive semidefinite with what the axes have of their own: moved together, " +
          listOf(names) + " would generate energy",
      "multiply the values off the diagonal by " + formatNumber(share) +
          " or less, or raise the diagonal",
      along};
}

void checkSum(Sum& sum, const DeviceModel& device) {
  if (sum.parts.empty()) return;
  const std::optional<Refusal> refusal = indefinite(sum.total, device);
  if (!refusal) return;
  const auto part_of = [&](const Sum::Part& part) {
    return refusal->direction.dot(part.matrix * refusal->direction);
  };
  auto worst =
      std::min_element(sum.parts.begin(), sum.parts.end(),
                       [&](const auto& a, const auto& b) { return part_of(a) < part_of(b); });
  if (worst->table.isGood(worst->key)) {
    worst->table.fail(worst->key, refusal->problem, refusal->remedy);
  }
}

}  // namespace

std::optional<LinkedAxes> readLinkedAxes(TomlTable& table, const DeviceModel& device) {
  LinkedAxes out;
  out.names = table.texts("axes");
  if (table.isGood("axes") && out.names.size() < 2) {
    table.fail("axes", "links nothing", "name two axes or more");
  }
  if (!table.isGood("axes") || !checkNames(table, out.names, device)) {
    table.ignoreUnknownKeys();
    return std::nullopt;
  }
  for (const std::string& name : out.names) {
    const int i = device.axisIndex(name);
    out.on_device.push_back(i);
    if (i < 0) {
      out.kinds.push_back(*knownAxisKind(name));
      out.lever_m.push_back(kAnyLever_m);
    } else {
      const DeviceAxis& axis = device.axes[i];
      out.kinds.push_back(axis.kind);
      out.lever_m.push_back(axis.kind == AxisKind::kTranslation ? 1.0 : axis.lever_arm_m);
    }
  }
  readLevers(table, out);
  return out;
}

std::string_view linkedKey(TomlTable& table, const LinkedAxes& axes, const AxisQuantity& quantity) {
  const bool shifts = every(axes, AxisKind::kTranslation);
  const bool turns = every(axes, AxisKind::kRotation);
  const std::string_view own = shifts  ? quantity.translation_key
                               : turns ? quantity.rotation_key
                                       : quantity.tip_key;
  for (const std::string_view key : {quantity.translation_key, quantity.rotation_key}) {
    if (key == own) continue;
    table.refuse(key, own,
                 shifts  ? "has the wrong unit: these axes are translations"
                 : turns ? "has the wrong unit: these axes are rotations"
                         : "has the wrong unit: these axes are translations and rotations");
  }
  if (shifts) table.refuse(quantity.tip_key, own, "is for rotations that end in a fingertip");
  const bool there = table.allowKey(own);
  if (shifts || !table.allowKey(quantity.tip_key)) return there ? own : std::string_view{};
  if (turns && there) {
    table.refuse(quantity.tip_key, own, "is given twice, at the tip and at the joint");
    return own;
  }
  for (std::size_t i = 0; i < axes.names.size(); ++i) {
    if (axes.lever_m[i] != 0.0) continue;
    table.fail(quantity.tip_key, "needs a lever arm, which " + axes.names[i] + " does not have",
               "add lever_m = { " + axes.names[i] + " = ... }");
    break;
  }
  return quantity.tip_key;
}

std::vector<double> linkedFactors(const LinkedAxes& axes, const AxisQuantity& quantity,
                                  std::string_view key) {
  if (key == quantity.tip_key) return axes.lever_m;
  return std::vector<double>(axes.names.size(), 1.0);
}

void readLinks(TomlTable& root, const DeviceModel& device, PatientConfig& config) {
  const int n = device.axisCount();
  std::array<Sum, 3> sums{Sum{kPersonMass, AxisMatrix::Zero(n, n), {}},
                          Sum{kPersonDamping, AxisMatrix::Zero(n, n), {}},
                          Sum{kPersonStiffness, AxisMatrix::Zero(n, n), {}}};
  const std::array<double PatientAxis::*, 3> own{&PatientAxis::mass, &PatientAxis::damping,
                                                 &PatientAxis::stiffness};
  for (TomlTable& table : root.tables("links", 0)) {
    const std::optional<LinkedAxes> axes = readLinkedAxes(table, device);
    if (!axes) continue;
    bool any = false, tip = false;
    for (Sum& sum : sums) {
      const std::string_view key = linkedKey(table, *axes, sum.quantity);
      tip = tip || key == sum.quantity.tip_key;
      if (key.empty() || !table.isGood(key)) continue;
      any = true;
      const AxisMatrix part = readMatrix(table, *axes, sum.quantity, key, n);
      sum.parts.push_back({table, std::string(key), part});
      sum.total += part;
    }
    if (table.keys().size() == (table.has("lever_m") ? 2U : 1U)) {
      table.fail("", "links nothing: it gives no mass, damping or stiffness",
                 "give one of them as a matrix, for instance stiffness_tip_n_m");
    } else if (any && !tip && table.has("lever_m")) {
      table.fail("lever_m", "has no effect: no key of this table is given at the tip", "remove it");
    }
  }
  std::array<AxisMatrix, 3> links;
  for (std::size_t s = 0; s < sums.size(); ++s) {
    Sum& sum = sums[s];
    for (int i = 0; i < n; ++i) {
      double& value = config.axes[i].*own[s];
      value += sum.total(i, i);
      sum.total(i, i) = value;
    }
    checkSum(sum, device);
    links[s] = sum.total;
    links[s].diagonal().setZero();
  }
  const bool linked =
      std::any_of(links.begin(), links.end(), [](const AxisMatrix& m) { return !m.isZero(0.0); });
  if (linked) config.links = {links[0], links[1], links[2]};
}

}  // namespace wholehand
