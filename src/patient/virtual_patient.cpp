#include "patient/virtual_patient.hpp"

namespace wholehand {

double impedanceEffort(const PatientAxis& person, double q, double qd, double q_intended,
                       double qd_intended) noexcept {
  return person.stiffness * (q_intended - q) + person.damping * (qd_intended - qd);
}

AxisEffort patientEffort(const PatientConfig& patient, const AxisPosition& q,
                         const AxisVelocity& qd, const AxisPosition& q_intended,
                         const AxisVelocity& qd_intended) noexcept {
  AxisEffort effort(q.size());
  for (int i = 0; i < q.size(); ++i) {
    effort[i] = impedanceEffort(patient.axes[i], q[i], qd[i], q_intended[i], qd_intended[i]);
  }
  return effort;
}

}  // namespace wholehand
