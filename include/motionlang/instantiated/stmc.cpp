// SPDX-License-Identifier: MIT
// STMC over the Eigen backend in float, compiled once for motionlang::instantiated.
#include <motionlang/generate/generate_motion.ipp>
#include <motionlang/stmc.hpp>
#include <motionlang/weights/stmc_file.hpp>

namespace ml = motionlang;
using B = ml::EigenBackend<float>;

template struct ml::Stmc<B>;
template ml::Stmc<B> ml::load_stmc<B>(const ml::FilePath&);
template ml::Motion ml::stmc_motion<B>(const ml::Tensor<B, 2>&, double);

using Model = ml::Stmc<B>;
template std::vector<ml::Motion> ml::generate_motions(const Model&, std::span<const ml::Timeline>,
                                                      const ml::GenerateOptions&);
template ml::Motion ml::generate_motion(const Model&, const ml::Timeline&, const ml::GenerateOptions&);
template void ml::require_own_motions(const Model&, std::span<const ml::Timeline>, const ml::GenerateOptions&);
