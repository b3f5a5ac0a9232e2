#pragma once

#include <tuple>

/// Tables of an independent program (series for the matrix exponential, repeated squaring for the
/// radius).
namespace wholehand::test {

/// Largest stiffness of a rigid contact, 30 Hz: mass [kg], damping [N·s/m], delay [ticks],
/// stiffness [N/m].
inline constexpr std::tuple<double, double, int, double> kRigidContactTable[] = {
    {0.1, 0.2, 0, 400},   {0.1, 0.2, 1, 133},  {0.1, 0.2, 2, 80},    {0.1, 1.0, 0, 2003},
    {0.1, 1.0, 1, 669},   {0.1, 1.0, 2, 402},  {0.1, 5.0, 0, 10084}, {0.1, 5.0, 1, 3379},
    {0.1, 5.0, 2, 2042},  {0.5, 0.2, 0, 400},  {0.5, 0.2, 1, 133},   {0.5, 0.2, 2, 80},
    {0.5, 1.0, 0, 2001},  {0.5, 1.0, 1, 667},  {0.5, 1.0, 2, 400},   {0.5, 5.0, 0, 10017},
    {0.5, 5.0, 1, 3343},  {0.5, 5.0, 2, 2009}, {1.0, 0.2, 0, 401},   {1.0, 0.2, 1, 134},
    {1.0, 0.2, 2, 80},    {1.0, 1.0, 0, 2001}, {1.0, 1.0, 1, 667},   {1.0, 1.0, 2, 400},
    {1.0, 5.0, 0, 10009}, {1.0, 5.0, 1, 3338}, {1.0, 5.0, 2, 2004}};

}  // namespace wholehand::test
