#include "record_views.hpp"

#include <cstddef>
#include <vector>

namespace py = pybind11;

namespace wholehand::python {
namespace {

py::array view(const Records& records, const py::dtype& type, const void* member,
               std::vector<py::ssize_t> shape, py::handle owner) {
  std::vector<py::ssize_t> strides;
  if (!shape.empty()) strides.push_back(type.itemsize());
  if (records.count > 0) {
    shape.insert(shape.begin(), records.count);
    strides.insert(strides.begin(), static_cast<py::ssize_t>(sizeof(TickRecord)));
  }
  py::array array(type, std::move(shape), std::move(strides), member, owner);
  array.attr("setflags")(py::arg("write") = false);
  return array;
}

py::dtype structOf(const std::vector<const char*>& names, const std::vector<const char*>& formats,
                   const std::vector<std::size_t>& offsets, std::size_t size) {
  py::list name_list, format_list, offset_list;
  for (std::size_t i = 0; i < names.size(); ++i) {
    name_list.append(names[i]);
    format_list.append(formats[i]);
    offset_list.append(offsets[i]);
  }
  return py::dtype(name_list, format_list, offset_list, static_cast<py::ssize_t>(size));
}

}  // namespace

py::array viewOf(const Records& records, const py::dtype& type, const void* member,
                 py::ssize_t size, py::handle owner) {
  return view(records, type, member, {size}, owner);
}

py::object viewOfOne(const Records& records, const py::dtype& type, const void* member,
                     py::handle owner) {
  py::array one = view(records, type, member, {}, owner);
  return records.count > 0 ? py::object(one) : one.attr("item")();
}

py::dtype bodyType() {
  return structOf({"position_m", "orientation_xyzw", "velocity_m_s", "angular_velocity_rad_s"},
                  {"(3,)f8", "(4,)f8", "(3,)f8", "(3,)f8"},
                  {offsetof(BodyState, position_m), offsetof(BodyState, orientation_xyzw),
                   offsetof(BodyState, velocity_m_s), offsetof(BodyState, angular_velocity_rad_s)},
                  sizeof(BodyState));
}

py::dtype contactType() {
  return structOf(
      {"capsule", "link", "body", "point_m", "normal", "force_n", "torque_nm", "distance_m"},
      {"i4", "i4", "i4", "(3,)f8", "(3,)f8", "(3,)f8", "(3,)f8", "f8"},
      {offsetof(Contact, capsule), offsetof(Contact, link), offsetof(Contact, body),
       offsetof(Contact, point_m), offsetof(Contact, normal), offsetof(Contact, force_n),
       offsetof(Contact, torque_nm), offsetof(Contact, distance_m)},
      sizeof(Contact));
}

}  // namespace wholehand::python
