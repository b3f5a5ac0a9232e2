#pragma once

#include "core/expected.hpp"
#include "core/geometry.hpp"

#include <tinyxml2.h>

#include <cstddef>
#include <string>
#include <vector>

namespace wholehand {

/// Strict reading of a URDF's elements: every fault is kept with its line and a key such as
/// "link[cup].collision[1].geometry", and reading continues with a harmless value. Internal to the
/// URDF reader.
class UrdfFaults {
 public:
  explicit UrdfFaults(std::string file) : file_(std::move(file)) {}

  void add(const tinyxml2::XMLElement* at, std::string key, std::string value, std::string problem,
           std::string remedy);
  /// Adds a fault of the whole file, or of a line (0: unknown) outside any element.
  void addAtLine(int line, std::string problem, std::string remedy);
  /// Adds what is no fault, but what the user should know.
  void note(const tinyxml2::XMLElement* at, std::string key, std::string value, Diagnostic notice);
  [[nodiscard]] const Diagnostics& all() const { return all_; }
  [[nodiscard]] const Diagnostics& notices() const { return notices_; }
  [[nodiscard]] const std::string& file() const { return file_; }

  /// Text of an attribute; empty, with a fault, when it is missing or empty.
  std::string text(const tinyxml2::XMLElement& e, const char* attribute, const std::string& key);
  /// Exactly `count` finite numbers separated by blanks; zeros, with a fault, otherwise.
  std::vector<double> numbers(const tinyxml2::XMLElement& e, const char* attribute,
                              const std::string& key, std::size_t count);
  /// One finite number > 0; 1, with a fault, otherwise.
  double positive(const tinyxml2::XMLElement& e, const char* attribute, const std::string& key);
  /// A dimension in [0.001, 10] m.
  double length_m(const tinyxml2::XMLElement& e, const char* attribute, const std::string& key);
  /// Pose of an element's `<origin xyz rpy>`; identity without one.
  Pose origin(const tinyxml2::XMLElement& parent, const std::string& key);

 private:
  std::string file_;
  Diagnostics all_;
  Diagnostics notices_;
};

}  // namespace wholehand
