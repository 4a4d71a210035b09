#include "text_sources.hpp"

#include <map>
#include <memory>
#include <set>

#include <motionlang/text/bag_of_words.hpp>
#include <motionlang/weights/text_encoder_folder.hpp>

#include "../usage_error.hpp"

namespace program {

using B = ml::EigenBackend<float>;

namespace {

TextStates states_from(const std::filesystem::path& from, const ml::TextEncoderOptions& options) {
  const auto asked = [](auto encoder) {
    return [encoder = std::make_shared<const decltype(encoder)>(std::move(encoder))](
               std::span<const std::string> texts) { return states_of(*encoder, texts); };
  };
  if (from.extension() != ".npy") return asked(ml::load_text_encoder<B>(from, options));
  return asked(ml::EmbeddingCache::read(from.parent_path(), from.stem().string()));
}

/// The bag of words of a text and of those that are about the same frames.
class WordsTogether {
 public:
  WordsTogether(const DescribedMotions& data, std::span<const std::string> texts) : words_(texts) {
    std::map<std::string, std::set<std::string>> beside;
    for (const auto* part : data.parts()) {
      for (const DescribedMotion& m : *part) {
        for (const DescribedText& a : m.texts) {
          for (const DescribedText& b : m.texts) {
            if (a.frames == b.frames) beside[a.text].insert(b.text);
          }
        }
      }
    }
    for (const auto& [text, all] : beside) {
      std::string& joined = joined_[text];
      for (const std::string& other : all) joined += other + "\n";
    }
  }
  template <ml::Backend C>
  ml::TextFeatures<C> encode(std::span<const std::string> texts) const {
    std::vector<std::string> joined;
    for (const std::string& t : texts) joined.push_back(joined_.at(t));
    return words_.encode<C>(joined);
  }

 private:
  ml::BagOfWords words_;
  std::map<std::string, std::string> joined_;
};

}  // namespace

bool reads_pieces(const TextTokensConfig& text, const std::filesystem::path& from) {
  if (text.encoder != "word_pieces" && text.encoder != "distilbert")
    ml::raise<ml::config_error>(103, "text.encoder '", text.encoder, "' is not word_pieces or distilbert");
  const bool pieces = text.encoder == "word_pieces";
  if (pieces != from.empty())
    ml::raise<usage_error>(102, pieces ? "--text-encoder is for text.encoder = distilbert"
                                       : "text.encoder = distilbert needs --text-encoder, a folder or a cache; "
                                         "without one: --set text.encoder=word_pieces");
  return pieces;
}

TextStates text_states(const std::filesystem::path& from) { return states_from(from, {}); }

ml::EmbeddingCache token_states(const std::filesystem::path& from, std::span<const std::string> texts) {
  return text_states(from)(texts);
}

ml::EmbeddingCache sentence_vectors(const std::filesystem::path& from, const DescribedMotions& data) {
  const auto texts = all_texts(data);
  if (from.empty()) return states_of(WordsTogether(data, texts), texts);
  return states_from(from, {.text = {.pooling = ml::Pooling::mean, .normalize = true}})(texts);
}

}  // namespace program
