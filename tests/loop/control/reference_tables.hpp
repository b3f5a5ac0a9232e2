#pragma once

#include <array>
#include <tuple>

/// Tables of an independent program (a series for the matrix exponential, repeated squaring for the
/// spectral radius).
namespace wholehand::test {

/// Largest stiffness of a rigid contact with a 30 Hz filter: mass [kg], damping [N·s/m], delay
/// [ticks], stiffness [N/m].
inline constexpr std::tuple<double, double, int, double> kRigidContactTable[] = {
    {0.1, 0.2, 0, 400},   {0.1, 0.2, 1, 133},  {0.1, 0.2, 2, 80},    {0.1, 1.0, 0, 2003},
    {0.1, 1.0, 1, 669},   {0.1, 1.0, 2, 402},  {0.1, 5.0, 0, 10084}, {0.1, 5.0, 1, 3379},
    {0.1, 5.0, 2, 2042},  {0.5, 0.2, 0, 400},  {0.5, 0.2, 1, 133},   {0.5, 0.2, 2, 80},
    {0.5, 1.0, 0, 2001},  {0.5, 1.0, 1, 667},  {0.5, 1.0, 2, 400},   {0.5, 5.0, 0, 10017},
    {0.5, 5.0, 1, 3343},  {0.5, 5.0, 2, 2009}, {1.0, 0.2, 0, 401},   {1.0, 0.2, 1, 134},
    {1.0, 0.2, 2, 80},    {1.0, 1.0, 0, 2001}, {1.0, 1.0, 1, 667},   {1.0, 1.0, 2, 400},
    {1.0, 5.0, 0, 10009}, {1.0, 5.0, 1, 3338}, {1.0, 5.0, 2, 2004}};

/// The same for 0.5 kg and 1 N·s/m with increasing damping Φ K_dm: delay [ticks], filter [Hz; 0:
/// none], stiffness.
inline constexpr std::array<double, 6> kDampings = {0, 2, 5, 10, 20, 40};
inline constexpr std::tuple<int, double, std::array<double, 6>> kDampedContactTable[] = {
    {0, 0, {2001, 5978, 11885, 21572, 40368, 75724}},
    {0, 100, {2001, 5762, 10901, 18429, 30785, 49059}},
    {0, 50, {2001, 5413, 9595, 15115, 23290, 34294}},
    {0, 30, {2001, 4907, 8073, 11941, 17349, 24330}},
    {0, 10, {2001, 3331, 4571, 5985, 7882, 10262}},
    {1, 0, {667, 1992, 3958, 7174, 13384, 24906}},
    {1, 100, {667, 1959, 3797, 6618, 11492, 18873}},
    {1, 50, {667, 1904, 3559, 5903, 9527, 14259}},
    {1, 30, {667, 1812, 3210, 5018, 7555, 10546}},
    {1, 10, {667, 1368, 2025, 2748, 3644, 4587}}};

}  // namespace wholehand::test
