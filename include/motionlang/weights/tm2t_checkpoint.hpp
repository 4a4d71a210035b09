// SPDX-License-Identifier: MIT
/// TM2T from one folder, trained here or published: the model from texts to motions, or the one from motions to texts.
///
///     const auto tm2t = load_tm2t<B>("checkpoints/t2m/T2M_Seq2Seq_NML1_Ear_SME0_N");
///     const auto motions = tm2t.model.generate(tm2t.words.encode<B>(texts), Philox{.seed = 7});
///
/// weights/tm2t_run.hpp describes both kinds of folders, and where it searches the motion tokenizer and the word
/// vectors.
#pragma once

#include <motionlang/weights/text_motion_checkpoint.hpp>
#include <motionlang/weights/tm2t_run.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// The model in the folder. The part of `model` for the opposite direction is empty. Throws what load_tm2t_run and
/// load_tm2t_describer throw.
template <Backend B>
Tm2tRun<B> load_tm2t(const FilePath& path, const Tm2tRunOptions& options = {}) {
  const RunFolder run = find_run(found_model_folder(path));
  return is_tm2t_describer(run) ? load_tm2t_describer<B>(run, options) : load_tm2t_run<B>(run, options);
}

MOTIONLANG_NAMESPACE_END
