// Golden functions: TM2T's pairs of motion tokens and words.
#include <motionlang/datasets/motion_tokens.hpp>
#include <motionlang/text/glove.hpp>
#include <motionlang/vae/motion_tokenizer.hpp>

#include "golden.hpp"

namespace {

using golden::Case, golden::Registration;
namespace ml = motionlang;
using ml::Index;

std::vector<Index> padded(std::vector<Index> ids, Index size, Index pad) {
  ids.resize(static_cast<std::size_t>(size), pad);
  return ids;
}

void training_sample(Case& c) {
  const auto config = c.config();
  const ml::GloVe glove(c.text()["words"].as<std::vector<std::string>>(), c.values<float>("in/vectors"),
                        c.shape("in/vectors")[1]);
  const ml::MotionVocabulary vocabulary{config["codebook"].as<Index>()};
  const Index longest = config["max_text_len"].as<Index>(), tokens = config["max_motion_len"].as<Index>();
  std::vector<ml::TokenEntry> entries;
  // in the order of the file, which nlohmann::json does not keep
  const auto text = nlohmann::ordered_json::parse(c.file().metadata().at("text"));
  for (const auto& [id, annotated] : text.at("annotations").items()) {
    std::string captions;
    for (const auto& line : annotated) captions += line.get<std::string>() + "\n";
    const auto name = "in/tokens_" + id;
    const auto flat = c.values<Index>(name);
    const Index width = c.shape(name)[1];
    ml::TokenLines lines;
    for (auto at = flat.begin(); at != flat.end(); at += width) lines.emplace_back(at, at + width);
    auto own = ml::token_entries(id, ml::parse_captions(captions), std::move(lines),
                                 {.tokens_per_second = config["tokens_per_second"].as<double>(), .cut_again = true});
    entries.insert(entries.end(), own.begin(), own.end());
  }
  std::string names;
  std::vector<Index> lengths;
  for (std::size_t i = 0; i < entries.size(); ++i) {
    const auto& entry = entries[i];
    names += (i > 0 ? "\n" : "") + entry.name;
    for (const auto& line : entry.lines) lengths.push_back(std::ssize(line));
    const auto n = std::to_string(i);
    const auto& line = entry.lines.at(c.scalar<std::size_t>("noise/line" + n));
    const auto drop = line.empty() || c.scalar<int>("noise/drop" + n) == 0 ? ml::TokenDrop::none
                      : c.scalar<int>("noise/drop_last" + n) != 0          ? ml::TokenDrop::last
                                                                           : ml::TokenDrop::first;
    const auto motion = ml::marked_tokens(line, vocabulary, drop);
    c.out("motion_ids" + n, padded(motion, tokens, vocabulary.pad()));
    c.out("motion_len" + n, {}, std::vector<Index>{std::ssize(motion) - 2});
    const auto& words = entry.captions.at(c.scalar<std::size_t>("noise/caption" + n)).words;
    const auto ids = ml::marked_words(glove, words, longest);
    c.out("sent_len" + n, {}, std::vector<Index>{std::ssize(ids)});
    c.out("word_ids" + n, padded(ids, longest + 2, config["text_pad"].as<Index>()));
    std::vector<float> vectors;
    for (const Index id : padded(ids, longest + 2, glove.id("unk"))) {
      const auto v = glove.vector(glove.word(id));
      vectors.insert(vectors.end(), v.begin(), v.end());
    }
    c.out("word_emb" + n, {longest + 2, glove.width()}, vectors);
  }
  c.out_text("entries_utf8", names);
  c.out("line_lengths", {std::ssize(entries), std::ssize(entries.at(0).lines)}, lengths);
}

const Registration sample{"tm2t training sample", "double", training_sample};

}  // namespace
