// One sentence out of several labels.
#include <doctest/doctest.h>

#include <motionlang/text/joined_labels.hpp>
#include <motionlang/text/tagged_word.hpp>

namespace ml = motionlang;
using Labels = std::vector<std::string>;
using enum ml::Conjunction;

namespace {

/// Every "run", "jump" and "waving" is a verb.
std::vector<ml::TaggedWord> tag(std::string_view sentence) {
  std::vector<ml::TaggedWord> out;
  while (!sentence.empty()) {
    const std::string word(sentence.substr(0, sentence.find(' ')));
    sentence.remove_prefix(std::min(sentence.size(), word.size() + 1));
    out.push_back({word, word == "run" || word == "jump" || word == "waving" ? "VERB" : "NOUN"});
  }
  return out;
}

}  // namespace

TEST_CASE("labels as one sentence") {
  const Labels none, one{"run"}, two{"run", "jump high"}, three{"run", "jump", "jump"};
  CHECK(ml::join_labels(one, simultaneously) == "run");
  CHECK(ml::join_labels(one, same_time) == "run");
  CHECK(ml::join_labels(two, simultaneously) == "simultaneously run and jump high");
  CHECK(ml::join_labels(two, comma) == "run, jump high");
  CHECK(ml::join_labels(three, same_time) == "run and jump and jump at the same time");
  CHECK(ml::join_labels(two, while_) == "run while jump high");  // no tagger
  CHECK(ml::join_labels(two, while_, tag) == "run while jumping high");
  CHECK(ml::join_labels(three, during, tag) == "run during jumping during jump");
  CHECK(ml::join_labels(Labels{"run", "waving"}, during, tag) == "run during waving");
  CHECK(ml::join_labels(Labels{"jump run"}, while_, tag) == "jump runing");  // single labels, too
  CHECK(ml::join_labels(two, comma, tag) == "run, jump high");
  CHECK(ml::join_labels(none, while_, tag).empty());
  CHECK(ml::join_labels(none, same_time).empty());
}
