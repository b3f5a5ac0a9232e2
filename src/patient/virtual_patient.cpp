#include "patient/virtual_patient.hpp"

#include <cmath>

namespace wholehand {

double impedanceEffort(const PatientAxis& person, double q, double qd, double q_intended,
                       double qd_intended) noexcept {
  return person.stiffness * (q_intended - q) + person.damping * (qd_intended - qd);
}

Pull pullOf(const PatientAxis& person, double q, double qd, double q_intended,
            double qd_intended) noexcept {
  const double effort = impedanceEffort(person, q, qd, q_intended, qd_intended);
  if (!(std::abs(effort) > person.strength)) return {q_intended, qd_intended};
  const double most = std::copysign(person.strength, effort);
  if (person.stiffness > 0.0) return {q + most / person.stiffness, qd};
  return {q, qd + most / person.damping};
}

double linkedEffort(const PatientLinks& links, int axis, const AxisPosition& e,
                    const AxisVelocity& ed) noexcept {
  if (links.stiffness.size() == 0) return 0.0;
  double effort = 0.0;
  for (int k = 0; k < e.size(); ++k) {
    effort += links.stiffness(axis, k) * e[k] + links.damping(axis, k) * ed[k];
  }
  return effort;
}

AxisEffort patientEffort(const PatientConfig& patient, const AxisPosition& q,
                         const AxisVelocity& qd, const AxisPosition& q_intended,
                         const AxisVelocity& qd_intended) noexcept {
  AxisEffort effort(q.size());
  AxisPosition e(q.size());
  AxisVelocity ed(q.size());
  for (int i = 0; i < q.size(); ++i) {
    effort[i] = impedanceEffort(patient.axes[i], q[i], qd[i], q_intended[i], qd_intended[i]);
    e[i] = q_intended[i] - q[i];
    ed[i] = qd_intended[i] - qd[i];
  }
  if (patient.links.stiffness.size() == 0) return effort;
  for (int i = 0; i < q.size(); ++i) effort[i] += linkedEffort(patient.links, i, e, ed);
  return effort;
}

}  // namespace wholehand
