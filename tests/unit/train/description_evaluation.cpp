// Descriptions against those of people: tags, scores, the table.
#include <motionlang/backend/eigen.hpp>
#include <motionlang/train/description_evaluation.hpp>

#include "../../support/check_error.hpp"
#include "../../support/motions_of_noise.hpp"
#include "../../support/official_tm2t.hpp"
#include "../../support/temporary_folder.hpp"

namespace ml = motionlang;
using ml::Index;
using B = ml::EigenBackend<float>;

TEST_CASE("words of a description get the tag that they have most often") {
  const auto text = [](std::vector<ml::TaggedWord> words) { return ml::DescribedText{"", {}, std::move(words)}; };
  const ml::DescribedMotion m{
      "1",
      "1",
      {},
      {text({{"man", "NOUN"}, {"walk", "VERB"}}), text({{"a", "DET"}, {"walk", "NOUN"}}), text({{"walk", "VERB"}})}};
  const ml::CommonTags tags({m});
  CHECK(tags.tagged("a man walk oddly") == "a/DET man/NOUN walk/VERB oddly/OTHER");
  CHECK(!tags.empty());
  CHECK(ml::CommonTags({}).tagged("a man") == "a man");
}

TEST_CASE("the model's words and random texts are compared with people's") {
  const ml::Tm2tRun<B> run{.model = official::tm2t(official::small_tm2t()),
                           .words = {official::tm2t_words, official::tm2t_vectors(), 4}};
  const ml::DescribedMotions data = motions_of_noise(
      263, 3, 5, [](int) { return Index{41}; },
      [](int i, Index) {
        return std::vector<ml::DescribedText>{{i % 2 == 0 ? "a person walk" : "a person turn", {0, 41}}};
      });
  const auto entries = ml::text_entries(data.validation, "validation");
  const auto figures = ml::description_figures<B>(run, data, entries, {}, {.seed = 2});
  REQUIRE(figures.rows.size() == 2);
  const ml::DescriptionScores &said = figures.rows[0], &chance = figures.rows[1];
  CHECK(said.by == "described");
  CHECK(!said.bert);
  CHECK(!said.r_precision);
  CHECK(chance.by == "a random text of the training part");
  CHECK(chance.bleu[0] >= 0.66);  // "a person" is always right
  std::vector<ml::CaptionPair> pairs;
  for (const ml::TextEntry& e : entries) {
    pairs.push_back(ml::entry_references(e, run.words));
    pairs.back().candidate =
        run.model
            .describe({ml::Tensor<B, 2>::from(ml::entry_rows(e, 0, 40, 263), {40, 263}), ml::Offsets{40}}, run.words)
            .front();
  }
  CHECK(said.rouge_l == ml::rouge_l(pairs));
  CHECK(said.bleu == ml::bleu(ml::corpus_counts(pairs)));
}

TEST_CASE("descriptions of another program are a row of their own; what is missing is reported") {
  const TemporaryFolder folder;
  const ml::Tm2tRun<B> run{.model = official::tm2t(official::small_tm2t()),
                           .words = {official::tm2t_words, official::tm2t_vectors(), 4}};
  const ml::DescribedMotions data = motions_of_noise(
      263, 3, 5, [](int) { return Index{41}; },
      [](int, Index) {
        return std::vector<ml::DescribedText>{{"a person walk", {0, 41}}};
      });
  const auto entries = ml::text_entries(data.validation, "validation");
  const auto write = [&](const ml::TextEntry& e, const char* text) {
    ml::write_file(folder / (e.motion->id + ".txt"), text);
  };
  write(entries[0], "a person walk\r\nand this is not read\n");
  CHECK_ERROR(ml::made_descriptions(folder.path, entries), "[motionlang.io.401]");
  CHECK_ERROR(ml::made_descriptions(folder.path, entries), entries[1].motion->id.c_str());
  write(entries[1], " \n");
  CHECK_ERROR(ml::made_descriptions(folder.path, entries), "[motionlang.io.402]");
  write(entries[1], "a person/walk");
  CHECK(ml::made_descriptions(folder.path, entries) == std::vector<std::string>{"a person walk", "a person walk"});
  const auto rows = ml::description_figures<B>(run, data, entries, {}, {.made = folder.path / ""}).rows;
  REQUIRE(rows.size() == 3);
  CHECK(rows[1].by == folder.path.filename().string());
  CHECK(rows[1].bleu[0] == doctest::Approx(1));
  CHECK(rows[1].rouge_l == doctest::Approx(1));
}

TEST_CASE("the table has the columns of its judges") {
  const ml::DescriptionScores plain{"described", {0.5, 0.25, 0.125, 0.0625}, 0.4, 1.5};
  CHECK(ml::description_table(std::span(&plain, 1)) ==
        "                                      BLEU-1  BLEU-2  BLEU-3  BLEU-4  ROUGE-L    CIDEr\n"
        "  described                            50.00   25.00   12.50    6.25    40.00   150.00\n");
  ml::DescriptionScores judged = plain;
  judged.bert = 0.321, judged.r_precision = {0.1, 0.2, 0.3}, judged.distance = 4;
  CHECK(ml::description_table(std::span(&judged, 1)) ==
        "                                         R@1     R@2     R@3  MM-Dist  BLEU-1  BLEU-2  BLEU-3  BLEU-4  ROUGE-L"
        "    CIDEr  BERTScore\n"
        "  described                            0.100   0.200   0.300    4.000   50.00   25.00   12.50    6.25    40.00"
        "   150.00      32.10\n");
  CHECK(ml::parse_bert_baseline("tm2t") == ml::BertBaseline::tm2t);
  CHECK_ERROR(ml::parse_bert_baseline("ten"), "[motionlang.config.103] baseline of BERTScore 'ten'");
}
