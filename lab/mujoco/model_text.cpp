#include "lab/mujoco/model_text.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <locale>
#include <sstream>
#include <vector>

namespace wholehand::mujoco {
namespace {

// Kinds of geoms. Two geoms collide if one of them lists the other's kind (conaffinity).
constexpr int kOfPalm = 2, kOfDigits = 4;
/// A rotation of the base stops this far beyond the device's range, as in ADR 19.
constexpr double kBeyondRange_rad = 0.1;
/// A joint limit becomes active within this distance of its end: the path of one tick at 50 rad/s
/// and 1 kHz.
constexpr double kNearEnd_rad = 0.05;
constexpr int kRowsPerContact = 4;
constexpr long kLeastStack = 100'000;

class Writer {
 public:
  Writer(const HandModel& hand, const SceneModel& scene, const SolverSettings& settings)
      : hand_(hand), scene_(scene), settings_(settings) {
    out_.imbue(std::locale::classic());
    out_.precision(17);
  }

  std::string write() {
    out_ << "<mujoco model='wholehand'>\n";
    writeOptions();
    writeMeshes();
    out_ << "<worldbody>\n";
    for (int i = 0; i < static_cast<int>(hand_.links.size()); ++i) {
      if (hand_.links[i].parent < 0) writeLink(i);
    }
    for (int i = 0; i < static_cast<int>(scene_.bodies.size()); ++i) writeBody(i);
    out_ << "</worldbody>\n";
    writeSelfContacts();
    out_ << "</mujoco>\n";
    return out_.str();
  }

 private:
  Writer& vector(const char* key, const Eigen::VectorXd& v) {
    out_ << ' ' << key << "='";
    for (Eigen::Index i = 0; i < v.size(); ++i) out_ << (i > 0 ? " " : "") << v[i];
    out_ << '\'';
    return *this;
  }
  void pose(const Pose& at) {
    const Eigen::Quaterniond q(at.rotation);
    vector("pos", at.translation_m);
    vector("quat", Eigen::Vector4d(q.w(), q.x(), q.y(), q.z()));
  }
  void inertial(double mass_kg, const Eigen::Vector3d& com_m, const Eigen::Matrix3d& i) {
    Eigen::VectorXd full(6);
    full << i(0, 0), i(1, 1), i(2, 2), i(0, 1), i(0, 2), i(1, 2);
    out_ << "<inertial mass='" << mass_kg << '\'';
    vector("pos", com_m).vector("fullinertia", full);
    out_ << "/>\n";
  }

  /// Twice the largest count of numbers that a step needs: the solver's matrices and vectors of
  /// rows.
  [[nodiscard]] long stackSize(long rows) const {
    const long bodies = std::count_if(scene_.bodies.begin(), scene_.bodies.end(),
                                      [](const SceneBody& body) { return !body.fixed; });
    const long dofs = hand_.joint_count + 6 * bodies;
    return 2 * dofs * (4 * dofs + rows) + 80 * rows + kLeastStack;
  }

  void writeOptions() {
    const long rows = kRowsPerContact * settings_.most_contacts + 2 * hand_.joint_count;
    out_ << "<compiler angle='radian' autolimits='false' inertiafromgeom='false'/>\n<option";
    vector("gravity", scene_.gravity_m_s2);
    out_ << " integrator='Euler' cone='elliptic' solver='Newton' jacobian='dense' iterations='"
         << settings_.iterations << "' tolerance='" << settings_.tolerance << "' impratio='"
         << settings_.friction_ratio << "'/>\n<size nconmax='" << settings_.most_contacts
         << "' njmax='" << rows << "' nstack='" << stackSize(rows)
         << "'/>\n<default><geom condim='3' margin='" << settings_.foresight_m << "' solimp='"
         << settings_.impedance << ' ' << settings_.impedance << " 0.001'/><joint solimplimit='"
         << settings_.impedance << ' ' << settings_.impedance << " 0.001' margin='" << kNearEnd_rad
         << "'/></default>\n";
  }

  void writeMeshes() {
    out_ << "<asset>\n";
    for (std::size_t i = 0; i < scene_.bodies.size(); ++i) {
      const std::vector<Shape>& shapes = scene_.bodies[i].shapes;
      for (std::size_t k = 0; k < shapes.size(); ++k) {
        if (!shapes[k].isMesh()) continue;
        out_ << "<mesh name='m" << i << '_' << k << "' vertex='";
        for (const Eigen::Vector3d& p : shapes[k].points_m) {
          out_ << p.x() << ' ' << p.y() << ' ' << p.z() << ' ';
        }
        out_ << "'/>\n";
      }
    }
    out_ << "</asset>\n";
  }

  void writeLink(int i) {
    const HandLink& link = hand_.links[i];
    out_ << "<body name='" << linkName(i) << '\'';
    pose(link.parent_to_link);
    out_ << ">\n";
    inertial(link.mass_kg, link.com_m, link.inertia_kg_m2);
    if (link.joint >= 0) writeJoint(i);
    for (std::size_t c = 0; c < hand_.capsules.size(); ++c) {
      if (hand_.capsules[c].link == i) writeCapsule(static_cast<int>(c));
    }
    for (int k = i + 1; k < static_cast<int>(hand_.links.size()); ++k) {
      if (hand_.links[k].parent == i) writeLink(k);
    }
    out_ << "</body>\n";
  }

  void writeJoint(int i) {
    const HandLink& link = hand_.links[i];
    out_ << "<joint name='" << jointName(link.joint) << "' type='"
         << (link.type == JointType::kRevolute ? "hinge" : "slide") << '\'';
    vector("axis", link.axis);
    if (i > hand_.palm_link) {
      out_ << " limited='true'";
      vector("range", Eigen::Vector2d(link.lower, link.upper));
    } else if (link.type == JointType::kRevolute) {
      out_ << " limited='true'";
      vector("range", baseRange(link.joint));
    }
    out_ << "/>\n";
  }

  [[nodiscard]] Eigen::Vector2d baseRange(int joint) const {
    double lower = hand_.theta0[joint], upper = lower;
    for (int a = 0; a < hand_.axis_count; ++a) {
      const double low = hand_.synergy(joint, a) * hand_.axis_lower[a];
      const double high = hand_.synergy(joint, a) * hand_.axis_upper[a];
      lower += std::min(low, high);
      upper += std::max(low, high);
    }
    return {lower - kBeyondRange_rad, upper + kBeyondRange_rad};
  }

  void writeCapsule(int c) {
    const Capsule& capsule = hand_.capsules[c];
    const bool palm = capsule.part == HandPart::kPalm;
    out_ << "<geom name='" << capsuleName(c) << "' contype='" << (palm ? kOfPalm : kOfDigits)
         << "' conaffinity='0' condim='4' size='" << capsule.radius_m << '\'';
    if ((capsule.b_m - capsule.a_m).norm() > 0.0) {
      Eigen::VectorXd ends(6);
      ends << capsule.a_m, capsule.b_m;
      out_ << " type='capsule'";
      vector("fromto", ends);
    } else {
      out_ << " type='sphere'";
      vector("pos", capsule.a_m);
    }
    out_ << "/>\n";
  }

  void writeBody(int i) {
    const SceneBody& body = scene_.bodies[i];
    const Pose at{body.pose.rotation, body.pose * body.com_m};
    out_ << "<body name='" << bodyName(i) << '\'' << (body.fixed ? " mocap='true'" : "");
    pose(at);
    out_ << ">\n";
    if (!body.fixed) {
      inertial(body.mass_kg, Eigen::Vector3d::Zero(), body.inertia_kg_m2);
      out_ << "<freejoint/>\n";
    }
    for (std::size_t k = 0; k < body.shapes.size(); ++k) {
      const Shape& shape = body.shapes[k];
      const bool soft = body.soft_m > 0.0;
      writeShape(i, k, shape, kOfBodies, kOfBodies | kOfPalm | (soft ? 0 : kOfDigits));
      if (soft) writeShape(i, k, coreOf(body, shape), 0, kOfDigits);
    }
    out_ << "</body>\n";
  }

  void writeShape(int body, std::size_t index, const Shape& shape, int kind, int meets) {
    Pose at = shape.in_body;
    at.translation_m -= scene_.bodies[body].com_m;
    out_ << "<geom contype='" << kind << "' conaffinity='" << meets << '\'';
    pose(at);
    out_ << " type='" << shape.kind().name << '\'';  // MuJoCo has the same names
    if (shape.isMesh()) {
      out_ << " mesh='m" << body << '_' << index << '\'';
    } else if (shape.isPolyhedron()) {
      vector("size", shape.half_extents_m);
    } else if (shape.kind().length_key == nullptr) {
      out_ << " size='" << shape.radius_m << '\'';
    } else {
      vector("size", Eigen::Vector2d(shape.radius_m, shape.length_m / 2.0));
    }
    out_ << "/>\n";
  }

  void writeSelfContacts() {
    out_ << "<contact>\n";
    for (const SelfPair& pair : hand_.self_contacts) {
      out_ << "<pair geom1='" << capsuleName(pair.capsule_a) << "' geom2='"
           << capsuleName(pair.capsule_b) << "' condim='3' margin='" << settings_.foresight_m
           << "' solimp='" << settings_.impedance << ' ' << settings_.impedance << " 0.001'/>\n";
    }
    out_ << "</contact>\n";
  }

  const HandModel& hand_;
  const SceneModel& scene_;
  const SolverSettings& settings_;
  std::ostringstream out_;
};

}  // namespace

std::string linkName(int link) {
  return "l" + std::to_string(link);
}
std::string jointName(int joint) {
  return "j" + std::to_string(joint);
}
std::string capsuleName(int capsule) {
  return "c" + std::to_string(capsule);
}
std::string bodyName(int body) {
  return "b" + std::to_string(body);
}

std::string modelText(const HandModel& hand, const SceneModel& scene,
                      const SolverSettings& settings) {
  return Writer(hand, scene, settings).write();
}

}  // namespace wholehand::mujoco
