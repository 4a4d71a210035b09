// SPDX-License-Identifier: MIT
/// What is wrong with a clip: the checks of `motionlang doctor`, and the repair of what can be repaired.
///
///     const Inspection found = inspect_motion(motion);
///     for (const Finding& f : found.findings) std::puts(f.text.c_str());
///     Motion better = mended(motion, found.cure);
///
/// A wrong scale or up axis is put right before the checks that follow it, so that each finding has one cause. All limits
/// are in SI units and named in InspectionLimits.
#pragma once

#include <algorithm>  // sort, max
#include <array>      // names
#include <cmath>      // round
#include <limits>     // lowest foot
#include <string>     // findings
#include <vector>     // findings

#include <motionlang/core/quantile.hpp>
#include <motionlang/kinematics/body_joints.hpp>
#include <motionlang/kinematics/motion_tools.hpp>

namespace motionlang::inline MOTIONLANG_ABI {

enum class Fault : int {
  empty,
  not_finite,
  frame_rate,
  lead_in,
  scale,
  up_axis,
  swapped_sides,
  spike,
  jump,
  sliding_feet,
  floor
};
struct FaultInfo {
  std::string_view name, meaning;
  bool mendable;
};
/// By Fault.
inline constexpr std::array<FaultInfo, 11> fault_info{{
    {"no motion", "fewer than two frames", false},
    {"not finite", "a value is NaN or infinite, or a rotation has length 0", false},
    {"frame rate", "no rate that cameras, engines or data sets use", false},
    {"T-pose", "an inserted T-pose at the start that nobody performed", true},
    {"scale", "the figure is not as tall as a person", true},
    {"up axis", "the figure does not stand along +Y", true},
    {"sides", "left and right are exchanged: names against the way the toes point", false},
    {"spike", "one frame stands out from both of its neighbours", true},
    {"jump", "a joint goes a way between two frames that nobody can go", false},
    {"sliding feet", "the foot that carries the body moves over the floor", false},
    {"floor", "the feet are not on y = 0", true},
}};
inline const FaultInfo& info(Fault fault) { return fault_info[static_cast<std::size_t>(fault)]; }

struct Finding {
  Fault fault;
  std::string text;   // with figures and units
  double moment = 0;  // seconds into the clip, of what happens at a time
};

/// What `mended` does, in this order. Frames count in the clip that was inspected.
struct Cure {
  std::vector<Index> spikes;               // frames that are replaced by the middle of their neighbours
  Index lead_in = 0;                       // frames that are cut off at the start
  Quaternion<double> upright{1, 0, 0, 0};  // turns the up axis of the clip to +Y
  double scale = 1;
  double lift = 0;  // metres, after scaling
};

struct Inspection {
  std::vector<Finding> findings;
  Cure cure;

  bool has(Fault fault) const {
    return std::any_of(findings.begin(), findings.end(), [&](const Finding& f) { return f.fault == fault; });
  }
};

struct InspectionLimits {
  double shortest = 1.0, tallest = 2.3;  // m: a person
  double doll = 0.3, giant = 5;          // m: between these a figure may be drawn so, unless it has a person's legs,
  double least_legs = 0.45, most_legs = 0.72;  // of the height up to the head; recordings have 0.55 to 0.67
  double upright = 0.8;      // mean direction of trunk and legs along another axis than +Y; 1: exactly
  double standing = 0.3;     // m that feet may be off 0 along an axis that is taken for the true one
  double swapped = 0.4;      // mean cosine between the right that names tell and the left that toes and knees tell
  double spike = 0.08;       // m that a joint is off the middle of its neighbours in time
  double jump = 0.15;        // m between two frames, and
  double jump_speed = 8;     // m/s: a fast punch or kick
  double isolated = 5;       // spikes and jumps: so many times what the joint does in the frames around
  double slide = 0.2;        // m/s of feet in contact, median over the contacts; recordings have 0.01 to 0.1
  double low = 0.03;         // m above where a foot joint is when it stands: still on the floor
  double carried = 0.4;      // of the length of the legs that the pelvis is above a foot that carries it: not of who swims or crawls
  double on_the_spot = 0.5;  // m across which the root moves in a clip in place
  double below = 0.08, above = 0.10;  // m that feet may be below or above y = 0
};

namespace detail {

/// Units of files by the factor from what was read to metres.
struct UnitFactor {
  double factor;
  std::string_view unit;
};
inline constexpr std::array<UnitFactor, 10> unit_factors{{
    {100, "the file is in metres where centimetres were expected"},
    {10, "decimetres"},
    {0.1, "millimetres where centimetres were expected"},
    {2.54, "inches where centimetres were expected"},
    {30.48, "feet where centimetres were expected"},
    {2.54 / 0.45, "the unit of CMU's files, 1/0.45 inch, where centimetres were expected"},
    {0.01, "centimetres where metres were expected"},
    {0.001, "millimetres where metres were expected"},
    {0.0254, "inches where metres were expected"},
    {1000, "metres where millimetres were expected"},
}};

inline double hundredths(double x) { return std::round(x * 100) / 100; }

/// From the ankles to the head in the rest pose; length 1.
inline Vec3<double> standing_direction(const Skeleton& skeleton, const BodyJoints& body) {
  const auto rest = skeleton.rest_positions();
  auto place = [&](int joint) { return rest[static_cast<std::size_t>(joint)]; };
  return normalized(place(body.head) - 0.5 * (place(body.ankle.left) + place(body.ankle.right)));
}

/// One clip under inspection: its joints in the world, put right as far as causes are known.
class MotionInspector {
 public:
  MotionInspector(const Motion& motion, const InspectionLimits& limits) : motion_(motion), limits_(limits) {}

  Inspection run() {
    if (!check_values()) return std::move(out_);
    check_frame_rate();
    out_.cure.lead_in = detect_t_pose_lead_in(motion_);
    if (out_.cure.lead_in > 0) {
      add(Fault::lead_in, 0, out_.cure.lead_in, out_.cure.lead_in == 1 ? " frame" : " frames",
          " of an inserted T-pose at the start");
    }
    first_ = out_.cure.lead_in;
    positions_ = motion_.positions();
    body_ = find_body_joints(motion_.skeleton);
    if (body_) {
      check_scale();
      check_up_axis();
      check_sides();
    }
    check_jumps();
    if (body_) check_feet();
    return std::move(out_);
  }

 private:
  using Vec = Vec3<double>;

  Vec& at(Index frame, Index joint) {
    return positions_[static_cast<std::size_t>(frame * motion_.skeleton.size() + joint)];
  }
  Vec middle(Index frame, const BodyJoints::Pair& p) { return 0.5 * (at(frame, p.left) + at(frame, p.right)); }
  double seconds(Index frame) const { return static_cast<double>(frame) / motion_.fps; }
  Index frames() const { return motion_.frames(); }

  template <class... T>
  void add(Fault fault, Index frame, const T&... text) {
    out_.findings.push_back({fault, concat_text(text...), seconds(frame)});
  }

  /// False if nothing else can be said.
  bool check_values() {
    for (Index f = 0; f < frames(); ++f) {
      const Vec& r = motion_.root_at(f);
      int wrong = std::isfinite(r.x + r.y + r.z) ? -1 : 0;
      for (int j = 0; j < motion_.skeleton.size() && wrong < 0; ++j) {
        const auto& q = motion_.rotations(f)[static_cast<std::size_t>(j)];
        const double length = dot(q, q);
        if (!std::isfinite(length) || length < 1e-12) wrong = j;
      }
      if (wrong < 0) continue;
      add(Fault::not_finite, f, "frame ", f, ", joint '", motion_.skeleton.name(wrong), "': not a number");
      return false;
    }
    if (frames() < 2) add(Fault::empty, 0, frames(), frames() == 1 ? " frame" : " frames");
    return frames() >= 2;
  }

  void check_frame_rate() {
    constexpr std::array<double, 25> usual{10,    12, 12.5, 15, 20, 23.976, 24,  25,     29.97, 30,  40,  48, 50,
                                           59.94, 60, 72,   75, 90, 100,    120, 119.88, 125,   150, 180, 200};
    constexpr std::array<double, 6> fast{240, 250, 300, 480, 500, 1000};
    auto near = [&](double rate) { return std::abs(motion_.fps / rate - 1) < 5e-4; };
    if (std::any_of(usual.begin(), usual.end(), near) || std::any_of(fast.begin(), fast.end(), near)) return;
    add(Fault::frame_rate, 0, hundredths(motion_.fps), " frames per second");
  }

  /// Sum of the bones from a joint up to one above it.
  double chain(int joint, int above) const {
    double sum = 0;
    for (; joint >= 0 && joint != above; joint = motion_.skeleton.parent(joint)) {
      if (motion_.skeleton.parent(joint) >= 0) sum += norm(motion_.skeleton.offset(joint));
    }
    return sum;
  }

  double leg_length() const {
    return 0.5 * (chain(body_->ankle.left, body_->hip.left) + chain(body_->ankle.right, body_->hip.right));
  }
  /// A person is about 1.2 times as tall as the bones from an ankle to the hip and from the pelvis to the head are long.
  void check_scale() {
    const double legs = leg_length();
    const double height = 1.2 * (legs + chain(body_->head, body_->pelvis));
    auto human = [&](double h) { return h >= limits_.shortest && h <= limits_.tallest; };
    if (human(height) || !(height > 0)) return;
    constexpr double usual_height = 1.7;
    UnitFactor best{usual_height / height, "no usual unit"};
    double farthest = std::log(limits_.tallest / limits_.shortest);
    for (const UnitFactor& u : unit_factors) {
      const double distance = std::abs(std::log(height * u.factor / usual_height));
      if (human(height * u.factor) && distance < farthest) best = u, farthest = distance;
    }
    const double share = legs / (legs + chain(body_->head, body_->pelvis));
    const bool person = share >= limits_.least_legs && share <= limits_.most_legs;
    if (!person && height > limits_.doll && height < limits_.giant) {
      add(Fault::scale, 0, "the figure is ", hundredths(height), " m tall, its legs are ", std::round(100 * share),
          " % of the height up to the head: drawn so, and left so");
      return;
    }
    add(Fault::scale, 0, "the figure is ", hundredths(height), " m tall; x ", std::round(best.factor * 1e4) / 1e4, " (",
        best.unit, ") makes it ", hundredths(height * best.factor), " m");
    out_.cure.scale = best.factor;
    for (Vec& p : positions_) p = best.factor * p;
  }

  /// Trunk and legs point up in most clips. Of those that lie, swim or crawl all the time, the feet would not be on the
  /// floor along the other axis, and their rest pose stands.
  void check_up_axis() {
    Vec trunk{}, legs{};
    for (Index f = first_; f < frames(); ++f) {
      const Vec hips = middle(f, body_->hip);
      trunk = trunk + normalized(middle(f, body_->shoulder) - hips);
      legs = legs + normalized(hips - middle(f, body_->ankle));
    }
    const double n = static_cast<double>(frames() - first_);
    const Vec rest = standing_direction(motion_.skeleton, *body_);
    struct Axis {
      std::string_view name;
      Vec direction;
    };
    for (const Axis& a :
         {Axis{"+Z", {0, 0, 1}}, {"-Z", {0, 0, -1}}, {"+X", {1, 0, 0}}, {"-X", {-1, 0, 0}}, {"-Y", {0, -1, 0}}}) {
      const double up = dot(trunk, a.direction) / n, down = dot(legs, a.direction) / n;
      if (up < limits_.upright || down < limits_.upright) continue;
      if (dot(rest, a.direction) < limits_.upright && std::abs(sole_height(a.direction)) > limits_.standing) continue;
      add(Fault::up_axis, first_, "the body stands along ", a.name, ", not +Y (", hundredths(up), " of 1)");
      out_.cure.upright = rotation_between(a.direction, Vec{0, 1, 0});
      for (Vec& p : positions_) p = rotate(out_.cure.upright, p);
      return;
    }
  }

  /// Left is where up x forward points. Toes point forward while a foot stands flat, and knees bend forward; both, where
  /// there is anything to see of them, must speak against the names.
  void check_sides() {
    struct Witness {
      double legs = 0, arms = 0, weight = 0;
    } toes, knees;
    for (Index f = first_; f < frames(); ++f) {
      const Vec ankles = middle(f, body_->ankle), hips = middle(f, body_->hip);
      auto hear = [&](Witness& witness, Vec forward, double least) {
        const double length = norm(forward);
        forward.y = 0;
        const double weight = norm(forward);
        if (weight < std::max(least, 0.7 * length)) return;
        const Vec left = normalized(cross(Vec{0, 1, 0}, forward));
        witness.legs += weight * dot(left, normalized(at(f, body_->hip.left) - at(f, body_->hip.right)));
        witness.arms += weight * dot(left, normalized(at(f, body_->shoulder.left) - at(f, body_->shoulder.right)));
        witness.weight += weight;
      };
      if (normalized(middle(f, body_->shoulder) - hips).y < 0.7) continue;  // lies or bends down
      if (body_->toe.known()) hear(toes, middle(f, body_->toe) - ankles, 0.05);
      hear(knees, middle(f, body_->knee) - 0.5 * (hips + ankles), 0.04);
    }
    auto wrong = [&](double Witness::*side) {
      double worst = 0;
      for (const Witness& w : {toes, knees}) {
        if (w.weight == 0) continue;
        if (w.*side > -limits_.swapped * w.weight) return 0.0;
        worst = std::min(worst, w.*side / w.weight);
      }
      return worst;
    };
    const double legs = wrong(&Witness::legs), arms = wrong(&Witness::arms);
    if (legs == 0 && arms == 0) return;
    add(Fault::swapped_sides, 0,
        legs < 0 && arms < 0 ? "left and right"
        : legs < 0           ? "the legs"
                             : "the arms",
        " are exchanged: where toes and knees say left, names say right (", hundredths(std::min(legs, arms)), " of 1)");
  }

  void check_jumps() {
    Index worst_jump = -1, worst_joint = 0, spike_joint = 0, jumps = 0;
    double worst = 0, worst_spike = 0;
    for (Index f = first_ + 1; f < frames(); ++f) {
      double off = 0, far = 0;
      Index off_joint = 0, far_joint = 0;
      for (Index j = 0; j < motion_.skeleton.size(); ++j) {
        if (const double e = spike_size(f, j); e > off) off = e, off_joint = j;
        if (const double s = jump_size(f, j); s > far) far = s, far_joint = j;
      }
      if (off > 0) {
        out_.cure.spikes.push_back(f);
        if (off > worst_spike) worst_spike = off, spike_joint = off_joint;
      } else if (far > 0) {
        ++jumps;
        if (far > worst) worst = far, worst_joint = far_joint, worst_jump = f;
      }
    }
    const auto& spikes = out_.cure.spikes;
    if (!spikes.empty()) {
      add(Fault::spike, spikes.front(), spikes.size(), spikes.size() == 1 ? " frame" : " frames", ", first at ",
          hundredths(seconds(spikes.front())), " s; '", motion_.skeleton.name(static_cast<int>(spike_joint)),
          "' up to ", hundredths(worst_spike), " m off");
    }
    if (worst_jump >= 0) {
      add(Fault::jump, worst_jump, jumps, jumps == 1 ? " jump" : " jumps", "; the widest at ",
          hundredths(seconds(worst_jump)), " s: '", motion_.skeleton.name(static_cast<int>(worst_joint)), "' goes ",
          hundredths(worst), " m in a frame, ", std::round(worst * motion_.fps), " m/s");
    }
  }

  double step(Index frame, Index joint) {  // from the frame before
    return frame <= first_ || frame >= frames() ? 0 : norm(at(frame, joint) - at(frame - 1, joint));
  }
  /// How far a joint is off the middle of its neighbours in time, where that is a spike; else 0.
  double spike_size(Index f, Index j) {
    if (f <= first_ || f + 1 >= frames()) return 0;
    const double off = norm(at(f, j) - 0.5 * (at(f - 1, j) + at(f + 1, j)));
    if (off < limits_.spike) return 0;
    const double around =
        std::max({norm(at(f + 1, j) - at(f - 1, j)), step(f - 1, j), step(f - 2, j), step(f + 2, j), step(f + 3, j)});
    return off > limits_.isolated * around ? off : 0;
  }
  double jump_size(Index f, Index j) {
    const double s = step(f, j);
    if (s < limits_.jump || s * motion_.fps < limits_.jump_speed) return 0;
    const double around = std::max({step(f - 2, j), step(f - 1, j), step(f + 1, j), step(f + 2, j)});
    return s > limits_.isolated * around ? s : 0;
  }

  std::vector<int> foot_joints() const {
    std::vector<int> feet{body_->ankle.left, body_->ankle.right};
    if (body_->toe.known()) feet.insert(feet.end(), {body_->toe.left, body_->toe.right});
    return feet;
  }
  /// Where the soles stand along a direction: 5 % of the frames have a foot lower than this.
  double sole_height(const Vec& up) {
    constexpr double toe_height = 0.02, ankle_height = 0.08;  // m above the sole
    std::vector<double> lowest;
    for (Index f = first_; f < frames(); ++f) {
      double low = std::numeric_limits<double>::max();
      for (const int foot : foot_joints()) low = std::min(low, dot(up, at(f, foot)));
      lowest.push_back(low);
    }
    return quantile(std::move(lowest), 0.05) - (body_->toe.known() ? toe_height : ankle_height);
  }

  /// How fast a leg's foot moves over the floor while it is on it, m/s: of every contact the speed that a quarter of it
  /// stays below, so that treading on and rolling off do not count.
  void add_contacts(std::span<const int> feet, std::vector<double>& speeds) {
    const double carried = limits_.carried * leg_length() * out_.cure.scale;
    // In steps of about 1/25 s, in which noise of the recording is small against the way of a foot that slides.
    const Index stride = std::max<Index>(1, std::lround(std::min(motion_.fps / 25, static_cast<double>(frames()))));
    std::vector<double> stands;  // the height at which a joint stands
    for (const int foot : feet) {
      std::vector<double> heights;
      for (Index f = first_; f < frames(); ++f) heights.push_back(at(f, foot).y);
      stands.push_back(quantile(std::move(heights), 0.05));
    }
    std::vector<double> contact;
    for (Index f = first_; f < frames(); f += stride) {
      double slowest = -1;
      for (std::size_t k = 0; k < feet.size() && f + stride < frames(); ++k) {
        const Vec &a = at(f, feet[k]), &b = at(f + stride, feet[k]);
        if (std::max(a.y, b.y) > stands[k] + limits_.low || at(f, body_->pelvis).y - a.y < carried) continue;
        const double speed = norm(Vec{b.x - a.x, 0, b.z - a.z}) * motion_.fps / static_cast<double>(stride);
        if (slowest < 0 || speed < slowest) slowest = speed;
      }
      if (slowest >= 0) {
        contact.push_back(slowest);
      } else if (!contact.empty()) {
        if (contact.size() > 1) speeds.push_back(quantile(contact, 0.25));
        contact.clear();
      }
    }
  }

  void check_feet() {
    const double sole = sole_height({0, 1, 0});
    if (std::abs(sole) <= limits_.standing) check_contacts();
    if (sole >= -limits_.below && sole <= limits_.above) return;
    add(Fault::floor, first_, "the feet are ", hundredths(std::abs(sole)), " m ", sole < 0 ? "below" : "above",
        " y = 0");
    out_.cure.lift = -sole;
  }
  /// Feet far off y = 0 swim, climb or hang, and carry nothing.
  void check_contacts() {
    std::vector<double> speeds;
    for (const bool left : {true, false}) {
      auto side = [&](const BodyJoints::Pair& p) { return left ? p.left : p.right; };
      std::vector<int> feet{side(body_->ankle)};
      if (body_->toe.known()) feet.push_back(side(body_->toe));
      add_contacts(feet, speeds);
    }
    if (const double speed = quantile(speeds, 0.5); speed > limits_.slide) {
      Vec low = at(first_, 0), high = low;
      for (Index f = first_; f < frames(); ++f) {
        const Vec& p = at(f, 0);
        low = {std::min(low.x, p.x), 0, std::min(low.z, p.z)};
        high = {std::max(high.x, p.x), 0, std::max(high.z, p.z)};
      }
      add(Fault::sliding_feet, first_, "standing feet slide at ", hundredths(speed), " m/s",
          norm(Vec{high.x - low.x, 0, high.z - low.z}) < limits_.on_the_spot ? "; a clip in place" : "");
    }
  }

  const Motion& motion_;
  const InspectionLimits& limits_;
  Inspection out_;
  std::optional<BodyJoints> body_;
  std::vector<Vec> positions_;  // (frames, joints)
  Index first_ = 0;             // frame after the lead-in
};

}  // namespace detail

/// All findings of a clip. Skeletons that no table of skeleton_tables.hpp fits are checked for values, frame rate, spikes
/// and jumps only. Throws config_error 106 for a malformed skeleton, 101 for a frame rate that is none, shape_error 205
/// if the arrays do not fit.
inline Inspection inspect_motion(const Motion& motion, const InspectionLimits& limits = {}) {
  motion.skeleton.validate();
  if (motion.local.size() != motion.root.size() * static_cast<std::size_t>(motion.skeleton.size())) {
    raise<shape_error>(205, "inspect_motion: '", motion.name, "' has ", motion.local.size(), " rotations for ",
                       motion.frames(), " frames of ", motion.skeleton.size(), " joints");
  }
  if (!(motion.fps > 0 && std::isfinite(motion.fps))) {
    raise<config_error>(101, "inspect_motion: '", motion.name, "' has a frame rate of ", motion.fps);
  }
  return detail::MotionInspector(motion, limits).run();
}

/// The clip with what the cure says. Throws shape_error 203 if it names frames that the clip does not have.
inline Motion mended(const Motion& motion, const Cure& cure) {
  Motion out = motion;
  for (const Index f : cure.spikes) {
    if (f < 1 || f + 1 >= motion.frames())
      raise<shape_error>(203, "mended: spike in frame ", f, " of ", motion.frames());
    out.root[static_cast<std::size_t>(f)] = 0.5 * (out.root_at(f - 1) + motion.root_at(f + 1));
    const auto pose = out.rotations(f), before = out.rotations(f - 1);
    const auto after = motion.rotations(f + 1);
    for (std::size_t j = 0; j < pose.size(); ++j) pose[j] = slerp(before[j], after[j], 0.5);
  }
  out = crop(out, cure.lead_in, out.frames());
  // The rest pose is turned along if it stands along the same axis as the figure.
  const auto& up = cure.upright;
  const auto body = find_body_joints(out.skeleton);
  const bool turn_rest = body && rotate(up, detail::standing_direction(out.skeleton, *body)).y > 0.7;
  for (Vec3<double>& r : out.root) r = cure.scale * rotate(up, r) + Vec3<double>{0, cure.lift, 0};
  for (auto* bones : {&out.skeleton.offsets, &out.skeleton.ends}) {
    for (Vec3<double>& o : *bones) o = cure.scale * (turn_rest ? rotate(up, o) : o);
  }
  for (Index f = 0; f < out.frames(); ++f) {
    const auto pose = out.rotations(f);
    if (turn_rest) {
      for (auto& q : pose) q = up * q * inverse(up);
    } else {
      pose[0] = up * pose[0];
    }
  }
  return out;
}

}  // namespace motionlang::inline MOTIONLANG_ABI
