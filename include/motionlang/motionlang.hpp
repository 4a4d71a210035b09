// SPDX-License-Identifier: MIT
/// The whole library but for what needs a third-party package: add the backends that you use, and the files.
///
///     #include <motionlang/motionlang.hpp>
///     #include <motionlang/backend/eigen.hpp>    // or backend/xtensor.hpp
///     #include <motionlang/io/bvh.hpp>           // and whichever of io/
#pragma once

#include <motionlang/fwd.hpp>
#include <motionlang/version.hpp>

#include <motionlang/core/activation.hpp>
#include <motionlang/core/buffer_pool.hpp>
#include <motionlang/core/concepts.hpp>
#include <motionlang/core/context.hpp>
#include <motionlang/core/dropout.hpp>
#include <motionlang/core/dual.hpp>
#include <motionlang/core/error.hpp>
#include <motionlang/core/fields.hpp>
#include <motionlang/core/half.hpp>
#include <motionlang/core/lane.hpp>
#include <motionlang/core/mt19937.hpp>
#include <motionlang/core/numpy_random.hpp>
#include <motionlang/core/offsets.hpp>
#include <motionlang/core/parallel.hpp>
#include <motionlang/core/progress.hpp>
#include <motionlang/core/python_random.hpp>
#include <motionlang/core/rng.hpp>
#include <motionlang/core/rounding.hpp>
#include <motionlang/core/scalar_math.hpp>
#include <motionlang/core/shape.hpp>
#include <motionlang/core/sort.hpp>
#include <motionlang/core/text_lines.hpp>
#include <motionlang/core/torch_random.hpp>
#include <motionlang/core/utf8.hpp>

#include <motionlang/tensor/fused.hpp>
#include <motionlang/tensor/gradient.hpp>
#include <motionlang/tensor/index.hpp>
#include <motionlang/tensor/module.hpp>
#include <motionlang/tensor/normalize.hpp>
#include <motionlang/tensor/ops.hpp>
#include <motionlang/tensor/sequences.hpp>
#include <motionlang/tensor/tensor.hpp>

#include <motionlang/geometry/axis_angle.hpp>
#include <motionlang/geometry/euler.hpp>
#include <motionlang/geometry/guo.hpp>
#include <motionlang/geometry/matrix.hpp>
#include <motionlang/geometry/pytorch3d.hpp>
#include <motionlang/geometry/quaternion.hpp>
#include <motionlang/geometry/rigid.hpp>
#include <motionlang/geometry/rotation6d.hpp>
#include <motionlang/geometry/slerp.hpp>
#include <motionlang/geometry/so3.hpp>
#include <motionlang/geometry/vec.hpp>

#include <motionlang/backend/autodiff.hpp>
#include <motionlang/backend/reference.hpp>

#include <motionlang/kinematics/blend.hpp>
#include <motionlang/kinematics/body.hpp>
#include <motionlang/kinematics/body_joints.hpp>
#include <motionlang/kinematics/body_model.hpp>
#include <motionlang/kinematics/body_motion.hpp>
#include <motionlang/kinematics/body_parts.hpp>
#include <motionlang/kinematics/chain_kinematics.hpp>
#include <motionlang/kinematics/chains.hpp>
#include <motionlang/kinematics/foot_contact.hpp>
#include <motionlang/kinematics/foot_lock.hpp>
#include <motionlang/kinematics/forward.hpp>
#include <motionlang/kinematics/lanes.hpp>
#include <motionlang/kinematics/limb_ik.hpp>
#include <motionlang/kinematics/loops.hpp>
#include <motionlang/kinematics/mirror_joints.hpp>
#include <motionlang/kinematics/motion.hpp>
#include <motionlang/kinematics/motion_from_joints.hpp>
#include <motionlang/kinematics/motion_tools.hpp>
#include <motionlang/kinematics/overlay.hpp>
#include <motionlang/kinematics/retarget.hpp>
#include <motionlang/kinematics/root_motion.hpp>
#include <motionlang/kinematics/sinc_part_motion.hpp>
#include <motionlang/kinematics/sinc_parts.hpp>
#include <motionlang/kinematics/skeleton.hpp>
#include <motionlang/kinematics/skeleton_tables.hpp>
#include <motionlang/kinematics/skinning.hpp>
#include <motionlang/kinematics/smooth_motion.hpp>
#include <motionlang/kinematics/smoothing.hpp>
#include <motionlang/kinematics/standard.hpp>
#include <motionlang/kinematics/surface_points.hpp>
#include <motionlang/kinematics/uniform_skeleton.hpp>

#include <motionlang/nn/batch_norm.hpp>
#include <motionlang/nn/bi_gru.hpp>
#include <motionlang/nn/conv1d.hpp>
#include <motionlang/nn/conv_stack.hpp>
#include <motionlang/nn/conv_transpose1d.hpp>
#include <motionlang/nn/dropout.hpp>
#include <motionlang/nn/embedding.hpp>
#include <motionlang/nn/gru.hpp>
#include <motionlang/nn/init.hpp>
#include <motionlang/nn/layer_norm.hpp>
#include <motionlang/nn/leaky_relu.hpp>
#include <motionlang/nn/linear.hpp>
#include <motionlang/nn/linear_attention.hpp>
#include <motionlang/nn/multihead_attention.hpp>
#include <motionlang/nn/pooling.hpp>
#include <motionlang/nn/positional_encoding.hpp>
#include <motionlang/nn/sequence_vae.hpp>
#include <motionlang/nn/text_features.hpp>
#include <motionlang/nn/timestep_embedding.hpp>
#include <motionlang/nn/transformer_decoder.hpp>
#include <motionlang/nn/transformer_encoder.hpp>

#include <motionlang/loss/cross_entropy.hpp>
#include <motionlang/loss/false_negatives.hpp>
#include <motionlang/loss/info_nce.hpp>
#include <motionlang/loss/kl.hpp>
#include <motionlang/loss/loss_terms.hpp>
#include <motionlang/loss/margin.hpp>
#include <motionlang/loss/reconstruction.hpp>

#include <motionlang/optim/adamw.hpp>
#include <motionlang/optim/ema.hpp>
#include <motionlang/optim/lr_schedule.hpp>

#include <motionlang/features/actor_points.hpp>
#include <motionlang/features/amass_resample.hpp>
#include <motionlang/features/amass_sequence.hpp>
#include <motionlang/features/frame_sampling.hpp>
#include <motionlang/features/guo_clip.hpp>
#include <motionlang/features/guoh3d.hpp>
#include <motionlang/features/guoh3d_extraction.hpp>
#include <motionlang/features/humanml3d_source.hpp>
#include <motionlang/features/joint_sets.hpp>
#include <motionlang/features/layout.hpp>
#include <motionlang/features/motion_features.hpp>
#include <motionlang/features/normalizer.hpp>
#include <motionlang/features/pose_representation.hpp>
#include <motionlang/features/rifke.hpp>
#include <motionlang/features/smplh_joints.hpp>
#include <motionlang/features/smplrifke.hpp>
#include <motionlang/features/smplvelp.hpp>
#include <motionlang/features/statistics.hpp>
#include <motionlang/features/tm2t_data.hpp>

#include <motionlang/vae/actor_autoregressive.hpp>
#include <motionlang/vae/actor_decoder.hpp>
#include <motionlang/vae/actor_encoder.hpp>
#include <motionlang/vae/actor_fully_connected.hpp>
#include <motionlang/vae/actor_gru.hpp>
#include <motionlang/vae/actor_latents.hpp>
#include <motionlang/vae/actor_losses.hpp>
#include <motionlang/vae/temos_encoder.hpp>
#include <motionlang/vae/temos_gru.hpp>
#include <motionlang/vae/text_motion.hpp>
#include <motionlang/vae/tmr_encoder.hpp>

#include <motionlang/diffusion/any_denoiser.hpp>
#include <motionlang/diffusion/denoiser.hpp>
#include <motionlang/diffusion/gaussian.hpp>
#include <motionlang/diffusion/guidance.hpp>
#include <motionlang/diffusion/mdm.hpp>
#include <motionlang/diffusion/mdm_smpl.hpp>
#include <motionlang/diffusion/motiondiffuse.hpp>
#include <motionlang/diffusion/respacing.hpp>
#include <motionlang/diffusion/sampler.hpp>
#include <motionlang/diffusion/schedule.hpp>

#include <motionlang/text/bag_of_words.hpp>
#include <motionlang/text/bert.hpp>
#include <motionlang/text/bert_tokenizer.hpp>
#include <motionlang/text/caption_encoder.hpp>
#include <motionlang/text/clip_text.hpp>
#include <motionlang/text/clip_tokenizer.hpp>
#include <motionlang/text/glove.hpp>
#include <motionlang/text/joined_labels.hpp>
#include <motionlang/text/mirror_caption.hpp>
#include <motionlang/text/tagged_word.hpp>
#include <motionlang/text/text_encoder.hpp>
#include <motionlang/text/text_repair.hpp>
#include <motionlang/text/token_offsets.hpp>
#include <motionlang/text/tokenized_encoder.hpp>
#include <motionlang/text/tokenizer.hpp>
#include <motionlang/text/unicode.hpp>
#include <motionlang/text/word_piece.hpp>
#include <motionlang/text/word_piece_tokens.hpp>

#include <motionlang/compose/alignment.hpp>
#include <motionlang/compose/babel_segment.hpp>
#include <motionlang/compose/baselines.hpp>
#include <motionlang/compose/body_part_answers.hpp>
#include <motionlang/compose/body_part_lexicon.hpp>
#include <motionlang/compose/collage.hpp>
#include <motionlang/compose/combine.hpp>
#include <motionlang/compose/handovers.hpp>
#include <motionlang/compose/intervals.hpp>
#include <motionlang/compose/mtt_timelines.hpp>
#include <motionlang/compose/options.hpp>
#include <motionlang/compose/plan.hpp>
#include <motionlang/compose/simultaneous_segments.hpp>
#include <motionlang/compose/sinc_assignment.hpp>
#include <motionlang/compose/sinc_composition.hpp>
#include <motionlang/compose/sinc_items.hpp>
#include <motionlang/compose/teach_pairs.hpp>
#include <motionlang/compose/timeline.hpp>
#include <motionlang/compose/timeline_text.hpp>
#include <motionlang/compose/transition.hpp>

#include <motionlang/metrics/accuracy.hpp>
#include <motionlang/metrics/ape_ave.hpp>
#include <motionlang/metrics/bert_score.hpp>
#include <motionlang/metrics/captions.hpp>
#include <motionlang/metrics/diversity.hpp>
#include <motionlang/metrics/frechet.hpp>
#include <motionlang/metrics/gru_classifier.hpp>
#include <motionlang/metrics/guo_evaluator.hpp>
#include <motionlang/metrics/guo_movement.hpp>
#include <motionlang/metrics/inspect_motion.hpp>
#include <motionlang/metrics/matching.hpp>
#include <motionlang/metrics/motion_quality.hpp>
#include <motionlang/metrics/mtt.hpp>
#include <motionlang/metrics/retrieval.hpp>
#include <motionlang/metrics/rows.hpp>
#include <motionlang/metrics/stgcn.hpp>
#include <motionlang/metrics/summary.hpp>
#include <motionlang/metrics/temos_score.hpp>

#include <motionlang/systems/actor.hpp>
#include <motionlang/systems/stmc.hpp>
#include <motionlang/systems/temos.hpp>
#include <motionlang/systems/tmr.hpp>

#include <motionlang/search/motion_index.hpp>
#include <motionlang/search/motion_search.hpp>
#include <motionlang/search/nearest.hpp>
#include <motionlang/search/unit_rows.hpp>
#include <motionlang/search/vector_scan.hpp>
