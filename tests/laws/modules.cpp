// Every module of the library. The denoisers are in the files of their own laws.
#include "../support/small_modules.hpp"
#include "module_laws.hpp"

using modules::Small;
namespace ml = motionlang;

TEST_CASE_TEMPLATE("laws of modules", M, Small<ml::Linear>, Small<ml::Embedding>, Small<ml::LayerNorm>,
                   Small<ml::Normalizer>, Small<ml::MultiheadAttention>, Small<ml::Gru>, Small<ml::TimestepEmbedding>,
                   Small<ml::TransformerEncoder>, Small<ml::TransformerDecoder>, Small<ml::CaptionEncoder>) {
  laws::module_laws<M>();
}
