// SPDX-License-Identifier: MIT
// The training of TM2T on the tape over the Eigen backend in float, compiled once for
// motionlang::instantiated_training.
#include <motionlang/backend/usual.hpp>
#include <motionlang/train/tm2t_describer_training.hpp>
#include <motionlang/train/tm2t_tokenizer_training.hpp>
#include <motionlang/train/tm2t_transformer_training.hpp>
#include <motionlang/train/tm2t_writer_training.hpp>

namespace ml = motionlang;
using A = ml::Autodiff<ml::EigenBackend<float>>;

template class ml::Tm2tTokenizerTraining<A>;
template class ml::Trainer<ml::Tm2tTokenizerTraining<A>>;
template class ml::Tm2tDescriberTraining<A>;
template class ml::Trainer<ml::Tm2tDescriberTraining<A>>;
template class ml::Tm2tTransformerTraining<A>;
template class ml::Trainer<ml::Tm2tTransformerTraining<A>>;
template class ml::Tm2tWriterTraining<A>;
template class ml::Trainer<ml::Tm2tWriterTraining<A>>;
