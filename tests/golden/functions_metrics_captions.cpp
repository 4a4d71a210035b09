// Golden functions: descriptions against references, and what Guo's loader makes of captions and clips.
#include <motionlang/datasets/described_words.hpp>
#include <motionlang/datasets/guo_clip.hpp>
#include <motionlang/metrics/bert_score.hpp>
#include <motionlang/metrics/captions.hpp>
#include <motionlang/text/glove.hpp>

#include "golden.hpp"

namespace {

using golden::Case, golden::Registration;
namespace ml = motionlang;
using ml::Index;

std::vector<ml::CaptionPair> pairs_of(const Case& c) {
  const auto candidates = c.text()["candidates"].as<std::vector<std::string>>();
  std::vector<ml::CaptionPair> out;
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    out.push_back({candidates[i], c.text()["references"][static_cast<Index>(i)].as<std::vector<std::string>>()});
  }
  return out;
}

void bleu(Case& c) {
  const auto pairs = pairs_of(c);
  const auto total = ml::corpus_counts(pairs);
  const Index n = std::ssize(pairs);
  std::vector<Index> correct, lengths;
  std::vector<double> each(4 * pairs.size());  // (4, sentences)
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const auto one = ml::bleu_counts(pairs[i]);
    const auto scores = ml::bleu(one);
    correct.insert(correct.end(), one.correct.begin(), one.correct.end());
    lengths.push_back(one.reference_length);
    for (std::size_t k = 0; k < 4; ++k) each[k * pairs.size() + i] = scores[k];
  }
  const auto scores = ml::bleu(total);
  c.out("correct", std::vector<Index>(total.correct.begin(), total.correct.end()));
  c.out("guess", std::vector<Index>(total.guess.begin(), total.guess.end()));
  c.out("candidate_length", {}, std::vector<Index>{total.length});
  c.out("reference_length", {}, std::vector<Index>{total.reference_length});
  c.out("correct_per_sentence", {n, 4}, correct);
  c.out("reference_length_per_sentence", lengths);
  c.out("bleu", std::vector<double>(scores.begin(), scores.end()));
  c.out("bleu_per_sentence", {4, n}, each);
}
void rouge(Case& c) {
  const auto pairs = pairs_of(c);
  const double beta = c.config().value_or("beta", 1.2);
  std::vector<double> each;
  for (const auto& p : pairs) each.push_back(ml::rouge_l(p, beta));
  c.out_scalar("rouge", ml::rouge_l(pairs, beta));
  c.out("rouge_per_sentence", each);
}
void cider(Case& c) {
  const auto pairs = pairs_of(c);
  const double sigma = c.config().value_or("sigma", 6.0);
  c.out_scalar("cider", ml::cider(pairs, sigma));
  c.out("cider_per_sentence", ml::cider_of_each(pairs, sigma));
}

template <class S>
void bert_score(Case& c) {
  const auto candidate_ids = c.values<Index>("in/cand_ids"), reference_ids = c.values<Index>("in/ref_ids");
  const auto candidate_rows = c.values<S>("in/cand_emb"), reference_rows = c.values<S>("in/ref_emb");
  const auto shape = c.shape("in/ref_emb");
  const Index count = shape[0], references = shape[1], width = shape[3], padding = c.config()["padding_id"].as<Index>();
  /// Sentence i of a padded list, without the padding.
  auto sentence = [&](const std::vector<Index>& ids, const std::vector<S>& rows, Index longest, Index i) {
    const auto first = ids.begin() + i * longest;
    const Index length = std::find(first, first + longest, padding) - first;
    return ml::BertSentence<S>{{first, first + length}, ml::Rows(rows, width).slice(i * longest, length)};
  };
  auto reference = [&](Index i) { return sentence(reference_ids, reference_rows, shape[2], i); };

  ml::BertWeights weights;
  for (Index i = 0; i < count * references; ++i) weights.add(reference(i).ids);
  auto all_weights = [&](const std::vector<Index>& ids) {
    std::vector<double> out;
    for (const Index id : ids) out.push_back(id == padding ? 0 : weights(id));
    return out;
  };
  c.out("idf_cand", c.shape("in/cand_ids"), all_weights(candidate_ids));
  c.out("idf_ref", c.shape("in/ref_ids"), all_weights(reference_ids));

  const auto b = c.config()["baseline"].as<std::vector<double>>();
  const ml::BertPadding padded{c.shape("in/cand_ids")[1], shape[2]};
  std::vector<double> raw, precision, recall, f;
  for (Index i = 0; i < count; ++i) {
    const auto candidate = sentence(candidate_ids, candidate_rows, padded.candidate, i);
    std::vector<ml::BertSentence<S>> own;
    for (Index r = 0; r < references; ++r) {
      own.push_back(reference(i * references + r));
      const auto s = ml::bert_score(candidate, own.back(), weights, padded);
      raw.insert(raw.end(), {s.precision, s.recall, s.f});
    }
    const auto s = ml::bert_score(candidate, std::span<const ml::BertSentence<S>>(own), weights,
                                  {b.at(0), b.at(1), b.at(2)}, padded);
    precision.push_back(s.precision), recall.push_back(s.recall), f.push_back(s.f);
  }
  c.out("raw_per_reference", {count, references, 3}, raw);
  c.out("P", precision);
  c.out("R", recall);
  c.out("F", f);
  c.out_scalar("F_mean", std::accumulate(f.begin(), f.end(), 0.0) / static_cast<double>(count));
}

ml::GloVe words_of(const Case& c) {
  return ml::GloVe(c.text()["words"].as<std::vector<std::string>>(), c.values<float>("in/vectors"),
                   c.shape("in/vectors")[1]);
}
/// Vectors and tags of words, (n, width) and (n, 15).
void out_words(Case& c, const ml::GloVe& glove, const std::vector<ml::TaggedWord>& words, const std::string& suffix) {
  std::vector<float> vectors;
  std::vector<int> tags(words.size() * ml::speech_tags);
  for (std::size_t i = 0; i < words.size(); ++i) {
    const auto v = glove.vector(words[i].word);
    vectors.insert(vectors.end(), v.begin(), v.end());
    tags[i * ml::speech_tags + static_cast<std::size_t>(glove.tag(words[i]))] = 1;
  }
  c.out("word_emb" + suffix, {std::ssize(words), glove.width()}, vectors);
  c.out("pos_onehot" + suffix, {std::ssize(words), ml::speech_tags}, tags);
}

void word_vectoriser(Case& c) {
  const auto glove = words_of(c);
  std::vector<ml::TaggedWord> words;
  for (const auto& token : c.text()["tokens"].as<std::vector<std::string>>())
    words.push_back(glove.tokens(token).at(0));
  out_words(c, glove, words, "");
  std::vector<Index> ids;
  for (const auto& w : words) ids.push_back(glove.id(w.word));
  c.out("ids", ids);
  std::string names;
  for (const Index id : c.text()["itos_ids"].as<std::vector<Index>>())
    names += (names.empty() ? "" : "\n") + glove.word(id);
  c.out_text("itos_utf8", names);
}

void loader_item(Case& c) {
  const auto config = c.config();
  const auto glove = words_of(c);
  const auto captions = c.text()["captions"].as<std::vector<std::string>>();
  const Index longest = config["max_text_len"].as<Index>(), unit = config["unit_length"].as<Index>();
  const auto mean = c.values<float>("in/mean"), std = c.values<float>("in/std");
  std::vector<Index> lengths;
  for (Index i = 0; c.has("in/clip" + std::to_string(i)); ++i)
    lengths.push_back(c.shape("in/clip" + std::to_string(i))[0]);
  auto limits = ml::guo_clip_limits(config["dataset"].as<std::string>() == "kit");
  limits.unit = unit;
  const auto kept = ml::guo_kept_clips(lengths, limits);
  c.out("kept_clips", kept);
  for (std::size_t k = 0; k < kept.size(); ++k) {
    const std::string suffix = std::to_string(k), clip = "in/clip" + std::to_string(kept[k]);
    auto words = ml::GloVe::framed(glove.tokens(captions.at(c.scalar<std::size_t>("noise/caption" + suffix))), longest);
    c.out("sent_len" + suffix, {}, std::vector<Index>{std::ssize(words)});
    words.resize(static_cast<std::size_t>(longest + 2), {"unk", "OTHER"});
    out_words(c, glove, words, suffix);
    const Index frames = ml::guo_item_frames(c.shape(clip)[0], c.scalar<int>("noise/double" + suffix) != 0, unit);
    c.out("length" + suffix, {}, std::vector<Index>{frames});
    const auto shape = c.shape("out/motion" + suffix);  // with rows of zeros behind
    auto motion = c.values<float>(clip);
    motion.erase(motion.begin(), motion.begin() + c.scalar<Index>("noise/start" + suffix) * shape[1]);
    motion.resize(static_cast<std::size_t>(frames * shape[1]));
    for (std::size_t i = 0; i < motion.size(); ++i)
      motion[i] = (motion[i] - mean[i % mean.size()]) / std[i % std.size()];
    motion.resize(static_cast<std::size_t>(shape.count()), 0);
    c.out("motion" + suffix, shape, motion);
  }
}

const Registration bleu_scores{"bleu", "double", bleu};
const Registration rouge_scores{"rouge-l", "double", rouge};
const Registration cider_scores{"cider", "double", cider};
const Registration bert64{"bertscore from embeddings", "double", bert_score<double>};
const Registration bert32{"bertscore from embeddings", "float", bert_score<float>};
const Registration vectoriser{"guo word vectoriser", "float", word_vectoriser};
const Registration loader{"guo loader item", "float", loader_item};

}  // namespace
