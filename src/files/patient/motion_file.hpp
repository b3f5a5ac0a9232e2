#pragma once

#include "loop/core/expected.hpp"
#include "loop/model/device_model.hpp"
#include "loop/patient/motion.hpp"

#include <string>

namespace wholehand {

/// Reads and checks a motion file: not empty, equal row lengths, finite values within ±1000,
/// strictly increasing time of at most an hour, no duplicate column, no rotation beyond 4π rad.
/// With `device`: no value farther from the first than ten times its axis's range, no step faster
/// than ten times its speed. Known axes are the nine standard ones and, with `device`, the device's
/// own; the unit in a column's name (s, ms, us, ns, m, cm, mm, rad, deg; "x_mm", "X (mm)") is
/// converted with a notice and must fit the axis. Positions in columns of another program ("Y (m)")
/// need a line "# up = y" or "# up = z"; a line "# columns: ..." says what other names are
/// (ColumnMap). The heads of OptiTrack Motive and Vicon Nexus are read (MocapHead). Columns of
/// other names are ignored with a notice. Values may be quoted (RFC 4180), and a first column
/// without a name numbers the rows. Lines end in \n, \r\n or \r; empty ones and those that start
/// with # are skipped. Reports every fault at once (the first 20). Not real-time safe.
[[nodiscard]] Expected<MotionFile> loadMotionFile(const std::string& path,
                                                  const DeviceModel* device = nullptr);

}  // namespace wholehand
