// With motionlang::instantiated, stmc.hpp has no bodies of what takes the caller's noise.
// expect: for generate_from and sample include <motionlang/systems/stmc.ipp>
#define MOTIONLANG_INSTANTIATED
#include <motionlang/stmc.hpp>
#ifndef MISTAKE
#include <motionlang/systems/stmc.ipp>
#endif

namespace ml = motionlang;
using B = ml::EigenBackend<float>;

std::vector<ml::Tensor<B, 2>> motions(const ml::Stmc<B>& stmc, const ml::Timeline& timeline);
std::vector<ml::Tensor<B, 2>> motions(const ml::Stmc<B>& stmc, const ml::Timeline& timeline) {
  return stmc.generate_from(std::span(&timeline, 1), [&](ml::Index draw, const ml::Shape& shape) {
    return stmc.noise(ml::Philox{}, draw, shape);
  });
}
