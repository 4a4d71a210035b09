// SPDX-License-Identifier: MIT
/// Everything for turning a timeline of texts into a motion: include this header.
///
///     namespace ml = motionlang;
///     using B = ml::EigenBackend<float>;
///     const auto stmc = ml::load_stmc<B>("stmc_free.safetensors");
///     const auto timeline = ml::parse_timeline("walk forward # 0.0 # 6.0 # legs\n"
///                                              "raise both arms # 2.0 # 5.0 # left arm # right arm\n");
///     const ml::Motion motion = ml::generate_motion(stmc, timeline, {.seed = 7});
///
/// stmc.generate and stmc_motion return the model's own output, without smoothing and foot fixing. Writers of BVH, GLB,
/// NPZ and pages are in <motionlang/formats/...> and <motionlang/view/...>. To calculate with the features (exp, max,
/// ...), also include <motionlang/backend/eigen.hpp>; otherwise the compiler asks for it.
///
/// With motionlang::instantiated, your code compiles several times faster. Stmc over EigenBackend<float> is then in the
/// library, and this header only declares it. For other backends, and for `generate_from`, also include
/// <motionlang/generate/generate_motion.ipp> and <motionlang/weights/stmc_file.hpp>; otherwise the compiler asks for
/// them.
#pragma once

#include <motionlang/backend/detail/eigen_class.hpp>
#include <motionlang/compose/timeline_text.hpp>
#include <motionlang/file/file_path.hpp>
#include <motionlang/generate/generate_motion.hpp>
#include <motionlang/systems/stmc.hpp>

#ifdef MOTIONLANG_INSTANTIATED
MOTIONLANG_NAMESPACE_BEGIN

template <Backend B>
Stmc<B> load_stmc(const FilePath& path);

extern template struct Stmc<EigenBackend<float>>;
extern template Stmc<EigenBackend<float>> load_stmc<EigenBackend<float>>(const FilePath&);
extern template Motion stmc_motion<EigenBackend<float>>(const Tensor<EigenBackend<float>, 2>&, double);

MOTIONLANG_NAMESPACE_END
#else
#include <motionlang/weights/stmc_file.hpp>
#endif
