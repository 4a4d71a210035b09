// Errors of the positions of joints, as evaluate prints them of TEMOS, TEACH and SINC: of several motions for each
// text, and of motions that know no text.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include <motionlang/core/rng.hpp>
#include <motionlang/metrics/ape_ave.hpp>

namespace program {

namespace ml = motionlang;

using Joints = std::vector<ml::Vec3<double>>;  // (frames, joints)
using JointErrors = ml::ApeAveMetric<double>;

/// What stands above the columns, and a row.
void print_error_heads();
void print_errors(const std::string& what, const ml::ApeAve& errors);

/// Errors of several motions for each text.
class SampledErrors {
 public:
  SampledErrors(const JointErrors& none, ml::Index samples)
      : of_sample_(static_cast<std::size_t>(samples), none), best_(none), worst_(none) {}

  void add(const std::vector<Joints>& samples, const Joints& truth);
  /// The first one of each text; of several also their mean, and the best and the worst of each text.
  void print() const;

 private:
  std::vector<JointErrors> of_sample_;
  JointErrors best_, worst_;
};

/// Errors of motions that know no text: the mean of all poses, seen from the body, standing still, and another, random
/// motion.
class BlindErrors {
 public:
  /// joints_of(i): those of motion i of so many to train on
  BlindErrors(const ml::RifkeVariant& variant, const JointErrors& none, ml::Index motions,
              std::function<Joints(ml::Index)> joints_of, std::uint64_t seed);

  /// own: the number of the motion itself, if it is among those to train on; it is not drawn where there are others.
  void add(const Joints& truth, ml::Index own = -1);
  void print() const;

 private:
  JointErrors pose_, clip_;
  ml::Index motions_;
  std::function<Joints(ml::Index)> joints_of_;
  Joints mean_;
  ml::Philox lot_;
};

}  // namespace program
