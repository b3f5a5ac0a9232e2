#include "impedance_text.hpp"

#include <cmath>
#include <numbers>

namespace wholehand {
namespace {

using Json = nlohmann::ordered_json;
using Impedances = std::vector<std::complex<double>>;

Json polarJson(const Impedances& z) {
  Json json{{"magnitude", Json::array()}, {"phase_deg", Json::array()}};
  for (const std::complex<double>& value : z) {
    json["magnitude"].push_back(std::abs(value));
    json["phase_deg"].push_back(std::arg(value) * 180.0 / std::numbers::pi);
  }
  return json;
}

Json deviationJson(const ImpedanceDeviation& deviation) {
  return {{"db", deviation.decibel}, {"deg", deviation.degrees}};
}

template <class Which>
Json bothJson(const ImpedanceCurve& curve, Which which) {
  Impedances felt, rendered;
  for (const ImpedancePoint& point : curve.points) {
    felt.push_back((point.*which).felt);
    rendered.push_back((point.*which).rendered);
  }
  Json json = polarJson(felt);
  json["rendering_alone"] = polarJson(rendered);
  return json;
}

Json curveJson(const ImpedanceCurve& curve) {
  Json json;
  json["contact"] = contactKey(curve.contact);
  json["phi"] = curve.phi;
  if (curve.contact == ContactCase::kObject) json["contact_stiffness"] = curve.stiffness;
  const ImpedancePoint& slow = curve.points.front();
  const double omega_rad_s = 2.0 * std::numbers::pi * slow.frequency_hz;
  const double reactive = best(curve, slow).imag();
  if (curve.contact == ContactCase::kFree) {
    json["felt_mass"] = reactive / omega_rad_s;
  } else {
    json["felt_stiffness"] = -reactive * omega_rad_s;
  }
  json["frequency_hz"] = Json::array();
  for (const ImpedancePoint& point : curve.points)
    json["frequency_hz"].push_back(point.frequency_hz);
  json["predicted"] = bothJson(curve, &ImpedancePoint::predicted);
  if (curve.not_measured.empty()) {
    json["world"] = curve.engine;
    json["measured"] = bothJson(curve, &ImpedancePoint::measured);
    json["deviation"] = deviationJson(curve.felt);
  } else {
    json["measured"] = nullptr;
    json["not_measured"] = curve.not_measured;
  }
  json["axis_alone_deviation"] = deviationJson(curve.alone);
  return json;
}

Json asBuiltJson(const ImpedanceAsBuilt& built) {
  Json json{{"frequency_hz", built.frequency_hz}, {"speed", built.speed}};
  json["linear"] = polarJson({built.linear});
  if (built.not_measured.empty()) {
    json["measured"] = polarJson({built.measured});
  } else {
    json["measured"] = nullptr;
    json["not_measured"] = built.not_measured;
  }
  return json;
}

}  // namespace

Json impedanceJson(const ImpedanceReport& report) {
  ImpedanceDeviation worst;
  Json axes = Json::array();
  for (const AxisImpedance& axis : report.axes) {
    Json json{{"name", axis.axis.name},
              {"unit", impedanceUnit(axis.axis)},
              {"position", axis.position},
              {"curves", Json::array()}};
    for (const ImpedanceCurve& curve : axis.curves) {
      json["curves"].push_back(curveJson(curve));
      if (curve.not_measured.empty()) worst.include(curve.felt);
    }
    json["as_built"] = asBuiltJson(axis.as_built);
    axes.push_back(std::move(json));
  }
  Json json;
  json["as_predicted"] = report.asPredicted();
  json["compared_hz"] = {kComparedFrom_hz, kComparedTo_hz};
  json["deviation"] = deviationJson(worst);
  json["contact_stiffness_n_m"] = report.contact_stiffness_n_m;
  json["axes"] = std::move(axes);
  return json;
}

}  // namespace wholehand
