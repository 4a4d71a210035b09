// SPDX-License-Identifier: MIT
/// Everything to turn a timeline of texts into a motion: include this one.
///
///     namespace ml = motionlang;
///     using B = ml::EigenBackend<float>;
///     const auto stmc = ml::load_stmc<B>("stmc_free.safetensors");
///     const auto timeline = ml::parse_timeline("walk forward # 0.0 # 6.0 # legs\n"
///                                              "raise both arms # 2.0 # 5.0 # left arm # right arm\n");
///     const ml::Motion motion = ml::generate_motion(stmc, timeline, {.seed = 7});
///
/// stmc.generate and stmc_motion give the model's own output, without smoothing and foot fixing. Writers of
/// BVH, GLB, NPZ and pages are in <motionlang/formats/...> and <motionlang/view/...>. Who calculates with the features
/// (exp, max, ...) includes <motionlang/backend/eigen.hpp> as well; the compiler says so.
///
/// Linking motionlang::instantiated compiles several times faster: Stmc over EigenBackend<float> is in the library
/// then, and this header only says what can be called. For other backends, and for `generate_from`, include
/// <motionlang/generate/generate_motion.ipp> and <motionlang/weights/stmc_file.hpp> as well; the compiler says so.
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
