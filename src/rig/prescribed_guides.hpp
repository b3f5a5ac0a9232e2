#pragma once

#include "certify/certificate.hpp"
#include "loop/renderer/person_guides.hpp"
#include "rig/models.hpp"

namespace wholehand {

/// Springs of a prescription on an axis, to the ground.
struct GuideStiffness {
  double wall = 0.0, corridor = 0.0;  ///< [N/m or N·m/rad]; 0: none
};

/// Stiffnesses per axis of the prescription's walls and corridor: what was asked, at most half each
/// of what device and gains bear, and then less where linked axes need it. Empty without a
/// prescription. Searched once in this process; any thread. Not real-time safe, as all below.
/// @param without input of certify() without the prescription
[[nodiscard]] std::vector<GuideStiffness> guideStiffnesses(const Models& models,
                                                           const CertificateInput& without);

/// Adds these springs to what a certificate must cover.
void addGuideWalls(CertificateInput& input, const std::vector<GuideStiffness>& guides);

/// Walls and corridor of the models' prescription. @pre models.prescription
[[nodiscard]] PersonGuidesConfig guidesOf(const Models& models, double period_s);

}  // namespace wholehand
