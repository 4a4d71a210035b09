// Every representation of rotations.
#include "rotation_laws.hpp"

namespace ml = motionlang;

TEST_CASE_TEMPLATE("laws of rotations", R, ml::Matrix3<float>, ml::Matrix3<double>, ml::Quaternion<float>,
                   ml::Quaternion<double>, ml::AxisAngle<float>, ml::AxisAngle<double>, ml::EulerAngles<float>,
                   ml::EulerAngles<double>, ml::Rotation6dRows<float>, ml::Rotation6dRows<double>,
                   ml::Rotation6dColumns<float>, ml::Rotation6dColumns<double>) {
  laws::rotation_laws<R>();
}
