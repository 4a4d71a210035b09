// SPDX-License-Identifier: MIT
/// Declarations of the types in interfaces. It includes the concepts but no third-party header.
///
///     #include <motionlang/fwd.hpp>
///     void play(const motionlang::Motion& motion, const motionlang::Timeline& timeline);
///     template <motionlang::Backend B> void train(motionlang::Linear<B>& layer);
///
/// A backend must be complete before it is used: Tensor<EigenBackend<float>, 2> needs the backend's header. Stmc is not
/// here because the denoiser constrains its parameters.
#pragma once

#include <motionlang/core/concepts.hpp>

MOTIONLANG_NAMESPACE_BEGIN

// core
class error;
class Offsets;
class Progress;
struct Context;
struct Philox;
template <Scalar S>
struct Dual;
template <Scalar S, int bytes>
struct Lane;

// tensor
template <Backend B, int Rank>
class Tensor;
template <Backend B>
struct Sequences;
template <AutodiffBackend A>
class Gradients;

// backend
template <Scalar S>
struct ReferenceBackend;
template <Scalar S>
struct EigenBackend;
template <Scalar S>
struct XtensorBackend;
template <Backend B>
struct Autodiff;

// geometry
template <class S>
struct Vec3;
template <class S>
struct Quaternion;
template <class S>
struct Matrix3;
template <class S>
struct AxisAngle;
template <class S>
struct EulerAngles;
template <class S>
struct Rigid;

// kinematics
class BodyPartition;
struct BodyParts;
struct Motion;
struct Skeleton;
template <ScalarLike S>
struct Pose;

// features
struct FeatureLayout;
struct IndexRange;
template <Backend B>
struct Normalizer;

// nn, text
template <Backend B>
struct Embedding;
template <Backend B>
struct LayerNorm;
template <Backend B>
struct Linear;
template <Backend B>
struct MultiheadAttention;
template <Backend B>
struct TransformerDecoder;
template <Backend B>
struct TransformerEncoder;
template <Backend B>
struct TextFeatures;
template <Backend B>
struct CaptionEncoder;
class WordPiece;

// diffusion, optim
class GaussianDiffusion;
template <Backend B>
struct MdmDenoiser;
template <Backend B>
struct MdmSmplDenoiser;
template <Backend B>
struct MotionDiffuseDenoiser;
template <AutodiffBackend A>
class AdamW;

// autoencoders and their systems
template <Backend B>
struct LatentGaussian;
template <Backend B>
struct LossTerms;
template <Backend B>
struct Actor;
struct ActorConfig;
template <Backend B>
struct StGcn;
template <Backend B>
struct GruClassifier;
template <Backend B>
struct Temos;
struct TemosConfig;
template <Backend B>
struct Tmr;
struct TmrConfig;
template <Backend B>
struct Teach;
struct TeachConfig;
template <Backend B>
struct Sinc;
struct SincConfig;

// compose
template <class T>
struct BasicInterval;
template <class T>
struct BasicTimeline;
using Interval = BasicInterval<Index>;
using Timeline = BasicTimeline<Index>;
using IntervalInSeconds = BasicInterval<double>;
using TimelineInSeconds = BasicTimeline<double>;
struct StmcOptions;

MOTIONLANG_NAMESPACE_END
