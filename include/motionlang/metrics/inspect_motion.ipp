// SPDX-License-Identifier: MIT
// Bodies of inspect_motion.hpp.
#pragma once

#include <cmath>   // round
#include <limits>  // lowest foot

#include <motionlang/core/quantile.hpp>
#include <motionlang/geometry/slerp.hpp>
#include <motionlang/geometry/so3.hpp>
#include <motionlang/kinematics/body_joints.hpp>
#include <motionlang/kinematics/motion_tools.hpp>
#include <motionlang/kinematics/up_axis.hpp>
#include <motionlang/metrics/inspect_motion.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// Units of files by the factor from the values in the file to metres.
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

/// Units of a root relative to those of its bones: centimetres, millimetres, inches, feet and so on.
inline constexpr std::array<double, 16> root_factors{100,    0.01,       1000,        0.001,      10,    0.1,
                                                     2.54,   1 / 2.54,   25.4,        1 / 25.4,   30.48, 1 / 30.48,
                                                     0.0254, 1 / 0.0254, 2.54 / 0.45, 0.45 / 2.54};

inline double hundredths(double x) { return std::round(x * 100) / 100; }

/// A parabola through values at whole steps, by least squares: its second derivative, and the root mean square of its
/// errors. At least three values.
struct ParabolaFit {
  double bend, off;
};

inline ParabolaFit fit_parabola(std::span<const double> values) {
  const auto n = static_cast<double>(values.size());
  auto t = [&](std::size_t i) { return static_cast<double>(i) - 0.5 * (n - 1); };  // 0 in the middle
  double t2 = 0, t4 = 0, sum = 0, sum_t = 0, sum_t2 = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double square = t(i) * t(i);
    t2 += square, t4 += square * square;
    sum += values[i], sum_t += t(i) * values[i], sum_t2 += square * values[i];
  }
  const double c2 = (sum_t2 - t2 * sum / n) / (t4 - t2 * t2 / n), c1 = sum_t / t2, c0 = (sum - c2 * t2) / n;
  double off = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double e = values[i] - (c0 + c1 * t(i) + c2 * t(i) * t(i));
    off += e * e / n;
  }
  return {2 * c2, std::sqrt(off)};
}

/// One clip under inspection: its joints in the world, corrected for the causes found so far.
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
    body_ = find_body_joints(motion_.skeleton);
    place_joints();
    if (body_) {
      check_scale();
      check_up_axis();
      check_root_unit();
      check_sides();
      check_falls();
    }
    check_jumps();
    if (body_) check_feet();
    return std::move(out_);
  }

 private:
  using Vec = Vec3<double>;

  Vec& at(Index frame, Index joint) { return positions_[static_cast<std::size_t>(frame * columns_ + joint)]; }
  Vec middle(Index frame, const BodyJoints::Pair& p) { return 0.5 * (at(frame, p.left) + at(frame, p.right)); }
  double seconds(Index frame) const { return static_cast<double>(frame) / motion_.fps; }
  Index frames() const { return motion_.frames(); }

  template <class... T>
  void add(Fault fault, Index frame, const T&... text) {
    out_.findings.push_back({fault, concat_text(text...), seconds(frame)});
  }

  /// False if no further check is possible.
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

  static bool usual_rate(double fps) {
    constexpr std::array<double, 25> usual{10,    12, 12.5, 15, 20, 23.976, 24,  25,     29.97, 30,  40,  48, 50,
                                           59.94, 60, 72,   75, 90, 100,    120, 119.88, 125,   150, 180, 200};
    constexpr std::array<double, 6> fast{240, 250, 300, 480, 500, 1000};
    auto near = [&](double rate) { return std::abs(fps / rate - 1) < 5e-4; };
    return std::any_of(usual.begin(), usual.end(), near) || std::any_of(fast.begin(), fast.end(), near);
  }
  void check_frame_rate() {
    if (!usual_rate(motion_.fps)) add(Fault::frame_rate, 0, hundredths(motion_.fps), " frames per second");
  }

  /// The ends of feet without toe joints, which BVH files have as End Site, are added after the joints as toes.
  void place_joints() {
    const auto& ends = motion_.skeleton.ends;
    auto end = [&](int joint) { return ends.empty() ? Vec{} : ends[static_cast<std::size_t>(joint)]; };
    const bool toes =
        body_ && !body_->toe.known() && norm(end(body_->ankle.left)) > 0 && norm(end(body_->ankle.right)) > 0;
    columns_ = motion_.skeleton.size() + (toes ? 2 : 0);
    positions_.reserve(static_cast<std::size_t>(frames() * columns_));
    JointTransforms<double> t;
    for (Index f = 0; f < frames(); ++f) {
      motion_.world(f, t);
      positions_.insert(positions_.end(), t.position.begin(), t.position.end());
      if (!toes) continue;
      for (const int ankle : {body_->ankle.left, body_->ankle.right}) {
        const auto a = static_cast<std::size_t>(ankle);
        positions_.push_back(t.position[a] + rotate(t.rotation[a], end(ankle)));
      }
    }
    if (toes) body_->toe = {motion_.skeleton.size(), motion_.skeleton.size() + 1};
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
  /// A person is about 1.2 times as tall as the bones from an ankle to the hip and from the pelvis to the head.
  void check_scale() {
    const double legs = leg_length();
    const double height = 1.2 * (legs + chain(body_->head, body_->pelvis));
    auto human = [&](double h) { return h >= limits_.shortest && h <= limits_.tallest; };
    if (human(height)) return;
    if (!(height > 0)) return add(Fault::scale, 0, "the legs, trunk and head of the figure have no length");
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

  /// Trunk and legs point up in most clips. The check also respects clips in which a person lies, swims or crawls all
  /// the time: their feet would not be on the floor along the other axis, and their rest pose stands.
  void check_up_axis() {
    const auto seen = std::span<const Vec>(positions_).subspan(static_cast<std::size_t>(first_ * columns_));
    const auto stands = find_up_axis({seen, columns_, *body_, standing_direction(motion_.skeleton, *body_)},
                                     {.upright = limits_.upright, .standing = limits_.standing});
    if (!stands) return;
    add(Fault::up_axis, first_, "the body stands along ", to_string(stands->axis), ", not +Y (",
        hundredths(stands->share), " of 1)");
    out_.cure.upright = upright_rotation(stands->axis);
    for (Vec& p : positions_) p = rotate(out_.cure.upright, p);
  }

  /// The bones now have the size of a person. A root in another unit holds the feet far off the floor, and they slide;
  /// with the right factor they come to the floor and stand there. Both must be true, because feet far off the floor
  /// may hang, and feet that slide may tread on the spot.
  void check_root_unit() {
    constexpr std::size_t fewest = 2;  // contacts
    const double off = sole_height({0, 1, 0});
    if (std::abs(off) <= limits_.standing) return;
    const std::vector<double> slides = contact_speeds();
    if (!slides.empty() && quantile(slides, 0.5) <= limits_.slide) return;
    const std::vector<Vec> as_read = positions_;
    for (const double factor : root_factors) {
      for (Index f = 0; f < frames(); ++f) {
        const Vec way = (factor - 1) * at(f, 0);
        for (Index j = 0; j < columns_; ++j) at(f, j) = at(f, j) + way;
      }
      const double sole = sole_height({0, 1, 0});
      const std::vector<double> speeds = contact_speeds();
      if (on_floor(sole) && speeds.size() >= fewest && quantile(speeds, 0.5) <= limits_.slide) {
        add(Fault::root_unit, first_, "the feet are ", hundredths(std::abs(off)), " m ", off < 0 ? "below" : "above",
            " y = 0; the root x ", std::round(factor * 1e4) / 1e4, " puts them there, where they stand");
        out_.cure.root = factor;
        return;
      }
      positions_ = as_read;
    }
  }

  /// Left is in the direction of up x forward. Toes point forward while a foot stands flat, and knees bend forward.
  /// Both, as far as they are visible, must contradict the names.
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

  /// Height of the centre of mass, by the shares of a body's parts and the points where they balance (Winter,
  /// Biomechanics and Motor Control of Human Movement, table 4.1).
  double mass_height(Index f) {
    const BodyJoints& b = *body_;
    auto along = [&](int from, int to, double t) { return (1 - t) * at(f, from).y + t * at(f, to).y; };
    auto limbs = [&](int BodyJoints::Pair::*side) {
      return 0.028 * along(b.shoulder.*side, b.elbow.*side, 0.436) +
             0.022 * along(b.elbow.*side, b.wrist.*side, 0.682) + 0.1 * along(b.hip.*side, b.knee.*side, 0.433) +
             0.0465 * along(b.knee.*side, b.ankle.*side, 0.433) + 0.0145 * at(f, b.ankle.*side).y;
    };
    return 0.081 * at(f, b.head).y + 0.497 * 0.5 * (middle(f, b.hip) + middle(f, b.shoulder)).y +
           limbs(&BodyJoints::Pair::left) + limbs(&BodyJoints::Pair::right);
  }

  /// The acceleration of the falling centre of mass between two bends of its path, m/s2 at the stated rate.
  struct Arcs {
    std::vector<double> flights;  // see is_flight
    std::vector<double> all;
  };
  Arcs arcs() {
    constexpr std::size_t fewest = 6;  // frames, because any few lie on a parabola
    // The length of the intervals over which bends are measured, against noise.
    const auto lag = 1 + static_cast<std::size_t>(std::min(motion_.fps / 60, static_cast<double>(frames())));
    std::vector<double> y;
    for (Index f = first_; f < frames(); ++f) y.push_back(mass_height(f));
    std::vector<double> feet = lowest_feet({0, 1, 0});
    const double stand = quantile(feet, 0.05);
    for (double& height : feet) height -= stand;
    Arcs out;
    for (std::size_t a = lag - 1, b = 0; a + 1 + lag < y.size(); a = std::max(a + 1, b - 1)) {
      for (b = a + 1; b + lag < y.size() && y[b - lag] - 2 * y[b] + y[b + lag] < 0;) ++b;
      if (b - a < fewest) continue;
      const auto [bend, off] = fit_parabola(std::span(y).subspan(a, b - a + 1));
      const double rise = -bend / 8 * static_cast<double>((b - a) * (b - a));
      if (rise < limits_.least_rise || off > limits_.parabola * rise) continue;
      const double fall = -bend * motion_.fps * motion_.fps;
      out.all.push_back(fall);
      if (rise < limits_.least_flight || !is_flight(a, std::span(feet).subspan(a, b - a + 1))) continue;
      out.flights.push_back(fall);
    }
    return out;
  }
  /// True if both feet leave the floor and return to it, with hands above the knees, so that nothing else carries the
  /// body.
  /// `feet` is the height of the lower foot above its standing height, from frame `start` after the lead-in on.
  bool is_flight(std::size_t start, std::span<const double> feet) {
    for (std::size_t i = 0; i < feet.size(); ++i) {
      const Index f = first_ + static_cast<Index>(start + i);
      if (std::min(at(f, body_->wrist.left).y, at(f, body_->wrist.right).y) < middle(f, body_->knee).y) return false;
    }
    const double ends = std::max(feet.front(), feet.back());
    const std::size_t quarter = feet.size() / 4;
    const auto air = feet.subspan(quarter, feet.size() - 2 * quarter);
    const double lowest = *std::min_element(air.begin(), air.end());
    return ends < 2 * limits_.off_floor && lowest > std::max(limits_.off_floor, ends + limits_.low);
  }

  /// The apparent acceleration of a fall is proportional to the square of the frame rate.
  void check_falls() {
    constexpr double gravity = 9.81;
    constexpr std::size_t fewest = 3;                            // steps
    if (out_.has(Fault::scale) && out_.cure.scale == 1) return;  // a doll may fall in any way
    const Arcs seen = arcs();
    const bool flies = !seen.flights.empty();
    if (!flies && seen.all.size() < fewest) return;
    const double fall = quantile(flies ? seen.flights : seen.all, 0.5);
    const double times = std::sqrt(fall / gravity);  // the stated rate over the true one, or over a higher one
    if (times < limits_.wrong_rate && (!flies || times > 1 / limits_.wrong_rate)) return;
    fps_ = motion_.fps / times;
    const double whole = times > 1 ? std::round(times) : 1 / std::round(1 / times);
    const double factor = std::max(times, 1 / times), whole_factor = std::max(whole, 1 / whole);
    const bool known =
        flies && std::abs(times / whole - 1) < 0.08 && whole_factor <= 5 && usual_rate(motion_.fps / whole);
    if (known) out_.cure.fps = fps_ = motion_.fps / whole;
    add(Fault::fall, first_, flies ? "in the air the body falls with " : "between steps the body sinks with ",
        hundredths(fall), " m/s2, not ", flies ? "" : "at most ", gravity, ": ",
        known   ? ""
        : flies ? "about "
                : "at least ",
        known ? whole_factor : hundredths(factor), " times too ", times > 1 ? "fast, " : "slow, ",
        known   ? ""
        : flies ? "about "
                : "at most ",
        known ? hundredths(fps_) : std::round(fps_), " frames per second, not ", hundredths(motion_.fps));
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
      } else if (far > 0 && (out_.cure.spikes.empty() || out_.cure.spikes.back() != f - 1)) {  // back from a spike
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
          hundredths(worst), " m in a frame, ", std::round(worst * fps_), " m/s");
    }
  }

  double step(Index frame, Index joint) {  // from the frame before
    return frame <= first_ || frame >= frames() ? 0 : norm(at(frame, joint) - at(frame - 1, joint));
  }
  double off_middle(Index f, Index j) {  // of its neighbours in time
    return f <= first_ || f + 1 >= frames() ? 0 : norm(at(f, j) - 0.5 * (at(f - 1, j) + at(f + 1, j)));
  }
  /// The distance of a joint from the middle of its neighbours in time, if that is a spike; else 0.
  double spike_size(Index f, Index j) {
    if (f <= first_ || f + 1 >= frames()) return 0;
    const double off = off_middle(f, j);
    if (off < limits_.spike) return 0;
    const double around =
        std::max({norm(at(f + 1, j) - at(f - 1, j)), step(f - 1, j), step(f - 2, j), step(f + 2, j), step(f + 3, j)});
    return off > limits_.isolated * around ? off : 0;
  }
  /// The distance of a joint from the frame before, if that is part of a jump; else 0. A jump is one to a few frames in
  /// a row that stand out from the others. It may also be a flicker, in which a known body's joint is impossibly fast
  /// or slow.
  double jump_size(Index f, Index j) {
    const double s = step(f, j);
    if (s * fps_ < limits_.jump_speed) return 0;
    const double off = std::max(off_middle(f - 1, j), off_middle(f, j));
    if (body_ && s >= limits_.spike && 2 * off * fps_ * fps_ > limits_.violent) return s;
    const double most = std::max(1.0, std::round(limits_.jump_seconds * fps_));
    auto fast = [&](Index frame) { return step(frame, j) * fps_ >= limits_.jump_speed; };
    Index from = f, to = f;  // the fast frames around
    auto n = [&] { return static_cast<double>(to - from + 1); };
    while (n() <= most && fast(from - 1)) --from;
    while (n() <= most && fast(to + 1)) ++to;
    const double way = norm(at(to, j) - at(from - 1, j));
    if (way < limits_.jump || n() > most) return 0;
    const double around = std::max({step(from - 2, j), step(from - 1, j), step(to + 1, j), step(to + 2, j)});
    return way / n() > limits_.isolated * around ? s : 0;
  }

  std::vector<int> foot_joints() const {
    std::vector<int> feet{body_->ankle.left, body_->ankle.right};
    if (body_->toe.known()) feet.insert(feet.end(), {body_->toe.left, body_->toe.right});
    return feet;
  }
  /// The height of the lower foot along a direction, by frames after the lead-in.
  std::vector<double> lowest_feet(const Vec& up) {
    std::vector<double> lowest;
    for (Index f = first_; f < frames(); ++f) {
      double low = std::numeric_limits<double>::max();
      for (const int foot : foot_joints()) low = std::min(low, dot(up, at(f, foot)));
      lowest.push_back(low);
    }
    return lowest;
  }
  /// The height of the soles along a direction: 5 % of the frames have a foot lower than this.
  double sole_height(const Vec& up) {
    constexpr double toe_height = 0.02, ankle_height = 0.08;  // m above the sole
    return quantile(lowest_feet(up), 0.05) - (body_->toe.known() ? toe_height : ankle_height);
  }

  bool on_floor(double sole) const { return sole >= -limits_.below && sole <= limits_.above; }

  /// The speed of a leg's foot over the floor during contact, m/s. It is the lower quartile of each contact, so that
  /// treading on and rolling off do not count.
  void add_contacts(std::span<const int> feet, std::span<const double> stands, std::vector<double>& speeds) {
    const double carried = limits_.carried * leg_length() * out_.cure.scale;
    // In steps of about 1/25 s, so that the noise of the recording is small compared with the distance that a foot
    // slides.
    const Index stride = std::max<Index>(1, std::lround(std::min(fps_ / 25, static_cast<double>(frames()))));
    std::vector<double> contact;
    for (Index f = first_; f < frames(); f += stride) {
      double slowest = -1;
      for (std::size_t k = 0; k < feet.size() && f + stride < frames(); ++k) {
        const Vec &a = at(f, feet[k]), &b = at(f + stride, feet[k]);
        if (std::max(a.y, b.y) > stands[k] + limits_.low || at(f, body_->pelvis).y - a.y < carried) continue;
        const double speed = norm(Vec{b.x - a.x, 0, b.z - a.z}) * fps_ / static_cast<double>(stride);
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
    Vec low = at(first_, 0), high = low;
    for (Index f = first_; f < frames(); ++f) {
      const Vec& p = at(f, 0);
      low = {std::min(low.x, p.x), 0, std::min(low.z, p.z)};
      high = {std::max(high.x, p.x), 0, std::max(high.z, p.z)};
    }
    const bool in_place = norm(Vec{high.x - low.x, 0, high.z - low.z}) < limits_.on_the_spot;
    if (on_floor(sole) || (!in_place && std::abs(sole) <= limits_.standing)) check_contacts(in_place);
    if (on_floor(sole)) return;
    add(Fault::floor, first_, "the feet are ", hundredths(std::abs(sole)), " m ", sole < 0 ? "below" : "above",
        " y = 0");
    out_.cure.lift = -sole;
  }
  std::vector<double> contact_speeds() {
    std::vector<BodyJoints::Pair> joints{body_->ankle};
    if (body_->toe.known()) joints.push_back(body_->toe);
    std::vector<double> stands;  // the height of each standing pair's lower foot: a foot that stays higher hangs
    for (const BodyJoints::Pair& p : joints) {
      std::vector<double> heights;
      for (Index f = first_; f < frames(); ++f) heights.push_back(std::min(at(f, p.left).y, at(f, p.right).y));
      stands.push_back(quantile(std::move(heights), 0.05));
    }
    std::vector<double> speeds;
    for (int BodyJoints::Pair::*side : {&BodyJoints::Pair::left, &BodyJoints::Pair::right}) {
      std::vector<int> feet;
      feet.reserve(joints.size());
      for (const BodyJoints::Pair& p : joints) feet.push_back(p.*side);
      add_contacts(feet, stands, speeds);
    }
    return speeds;
  }
  /// Feet far off y = 0 swim, climb or hang, and carry nothing. In place, where a swimmer treads water, this is true
  /// for feet that are off y = 0 at all.
  void check_contacts(bool in_place) {
    if (const double speed = quantile(contact_speeds(), 0.5); speed > limits_.slide) {
      add(Fault::sliding_feet, first_, "standing feet slide at ", hundredths(speed), " m/s",
          in_place ? "; a clip in place" : "");
    }
  }

  const Motion& motion_;
  const InspectionLimits& limits_;
  Inspection out_;
  std::optional<BodyJoints> body_;
  std::vector<Vec> positions_;  // (frames, columns)
  Index columns_ = 0;           // joints, and toes that place_joints adds
  Index first_ = 0;             // frame after the lead-in
  double fps_ = motion_.fps;    // the true one, as far as it is known
};

}  // namespace detail

MOTIONLANG_BODY Inspection inspect_motion(const Motion& motion, const InspectionLimits& limits) {
  motion.skeleton.validate();
  if (motion.local.size() != motion.root.size() * static_cast<std::size_t>(motion.skeleton.size())) {
    raise<shape_error>(205, "inspect_motion: '", motion.name, "' has ", counted(motion.local.size(), "rotation"),
                       " for ", counted(motion.frames(), "frame"), " of ", counted(motion.skeleton.size(), "joint"));
  }
  if (!(motion.fps > 0 && std::isfinite(motion.fps))) {
    raise<config_error>(101, "inspect_motion: '", motion.name, "' has a frame rate of ", motion.fps);
  }
  return detail::MotionInspector(motion, limits).run();
}

MOTIONLANG_BODY Motion mended(const Motion& motion, const Cure& cure) {
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
  if (cure.fps > 0) out.fps = cure.fps;
  out = turned_upright(out, cure.upright);
  for (Vec3<double>& r : out.root) r = cure.scale * cure.root * r + Vec3<double>{0, cure.lift, 0};
  for (auto* bones : {&out.skeleton.offsets, &out.skeleton.ends}) {
    for (Vec3<double>& o : *bones) o = cure.scale * o;
  }
  return out;
}

MOTIONLANG_NAMESPACE_END
