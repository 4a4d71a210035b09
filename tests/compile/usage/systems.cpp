// Names that the usage examples of systems/ use without declaring them.
#include "usage.hpp"

#include <motionlang/compose/timeline_text.hpp>
#include <motionlang/systems/actor.hpp>
#include <motionlang/systems/sinc.hpp>
#include <motionlang/systems/stmc_edit.hpp>
#include <motionlang/systems/stmc_keep.hpp>
#include <motionlang/systems/teach.hpp>
#include <motionlang/systems/temos.hpp>
#include <motionlang/systems/tm2t.hpp>
#include <motionlang/systems/tmr.hpp>
#include <motionlang/text/bert.hpp>
#include <motionlang/text/bert_tokenizer.hpp>
#include <motionlang/text/glove.hpp>
#include <motionlang/text/joined_labels.hpp>
#include <motionlang/weights/stmc_file.hpp>

void actor_(const Actor<B>& actor, const std::vector<Index>& labels, Philox& rng) {
#include "systems/actor.1.inc"
}
void sinc_(const Sinc<B>& sinc, const Normalizer<B>& normalizer, const DistilBert<B>& distilbert,
           const BertTokenizer& tokenizer, const std::vector<std::string>& labels) {
#include "systems/sinc.1.inc"
}
void edit(const Stmc<B>& stmc, std::vector<Timeline>& timelines) {
#include "systems/stmc_edit.1.inc"
}
void keep(const Stmc<B>& stmc, const Timeline& timeline, const Tensor<B, 2>& features) {
#include "systems/stmc_keep.1.inc"
}
void teach_(const Teach<B>& teach, const Normalizer<B>& normalizer, const DistilBert<B>& distilbert,
            const BertTokenizer& tokenizer) {
#include "systems/teach.1.inc"
}
void temos_(const Temos<B>& temos, const Normalizer<B>& normalizer, const DistilBert<B>& distilbert,
            const BertTokenizer& tokenizer, const std::vector<std::string>& texts) {
#include "systems/temos.1.inc"
}
void tm2t_(const Tm2t<B>& tm2t, const GloVe& glove, const Sequences<B>& features, const std::vector<std::string>& texts,
           const Philox& rng) {
#include "systems/tm2t.1.inc"
}
void tmr_(const Tmr<B>& tmr, const Sequences<B>& states, const Sequences<B>& features) {
#include "systems/tmr.1.inc"
}
