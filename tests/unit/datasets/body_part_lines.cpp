// Questions, answers and truths about body parts in files; labels of BABEL; tags of labels.
#include <motionlang/datasets/body_part_lines.hpp>
#include <motionlang/datasets/body_part_table.hpp>
#include <motionlang/datasets/label_tags.hpp>
#include <motionlang/file/file.hpp>
#include <motionlang/file/json.hpp>

#include "../../support/check_error.hpp"
#include "../../support/temporary_folder.hpp"

namespace ml = motionlang;

TEST_CASE("a question is a line of JSON; answers in lines become the table that trainings read") {
  const std::vector<std::string> labels{"wave \"hello\"", "sit"};
  const std::string lines = ml::body_part_questions(labels, ml::BodyPartPrompt::free_form);
  CHECK(std::count(lines.begin(), lines.end(), '\n') == 2);
  const auto first = ml::parse_json(lines.substr(0, lines.find('\n')));
  CHECK(first.at("label") == "wave \"hello\"");
  CHECK(first.at("prompt") == "List the body parts involved in this action: wave \"hello\"");

  const TemporaryFolder folder;
  ml::write_file(folder / "answers.jsonl", std::string_view("{\"label\": \"sit\", \"answer\": \"left leg\"}\n\n"
                                                            "{\"label\": \"wave\", \"answer\": \"right arm\"}\n"
                                                            "{\"label\": \"sit\", \"answer\": \"right leg\"}\n"));
  const auto answers = ml::read_body_part_answers(folder / "answers.jsonl");
  REQUIRE(answers.size() == 3);
  CHECK(answers[1] == std::pair<std::string, std::string>("wave", "right arm"));
  ml::write_file(folder / "table.json", std::string_view(ml::body_part_table_text(answers)));
  const auto table = ml::open_body_part_table(folder / "table.json");
  CHECK(table.labels() == std::vector<std::string>{"sit", "wave"});
  CHECK(ml::has(table.parts("sit"), ml::SincPart::right_leg));
  CHECK(!ml::has(table.parts("sit"), ml::SincPart::left_leg));  // the last answer counts
  CHECK(ml::read_body_part_answers(folder / "table.json").size() == 2);
  CHECK_ERROR(ml::parse_body_part_answers("{\"label\": \"sit\"}\n", "a"), "[motionlang.config.107]");
  CHECK_ERROR(ml::parse_body_part_answers("\n{\n", "a.jsonl"), "a.jsonl:2");
}

TEST_CASE("labels on lines, and those without an answer that names a part") {
  const auto labels = ml::parse_label_list("wave\r\nsit\n\nwave\njump\n");
  CHECK(labels == std::vector<std::string>{"jump", "sit", "wave"});
  const ml::BodyPartAnswers answers{{"sit", "the sofa"}, {"jump", "left leg\nright leg"}, {"run", "legs"}};
  CHECK(ml::unanswered_labels(labels, answers) == std::vector<std::string>{"sit", "wave"});
}

TEST_CASE("what people say: six columns of 0, 1 and 0.5") {
  const auto truth = ml::parse_body_part_truth("# label\twalk\nwalk\t1\t0.5\t0\t0\t1\t1\n\nwave\t0\t0\t0\t1\t0\t0\n");
  CHECK(truth.labels == std::vector<std::string>{"walk", "wave"});
  CHECK(truth.wanted == std::vector<double>{1, 0.5, 0, 0, 1, 1, 0, 0, 0, 1, 0, 0});
  CHECK_ERROR(ml::parse_body_part_truth("walk\t1\n", "t"), "[motionlang.io.403] t:1: 2 fields");
  CHECK_ERROR(ml::parse_body_part_truth("walk\t1\t0\t0\t0\t0\t2\n", "t"), "t:1: '2' is not 0, 0.5 or 1");
}

TEST_CASE("labels of BABEL without their motions, sorted and spelled") {
  const TemporaryFolder folder;
  const auto label = [](const char* text, const char* times) {
    return std::string(R"({"raw_label": "", "proc_label": ")") + text + R"(", "seg_id": "", "act_cat": null)" + times +
           "}";
  };
  ml::write_file(
      folder / "babel.json",
      R"({"1": {"babel_sid": 1, "url": "", "feat_p": "A/A/1.npz", "dur": 4.0, "seq_ann": null, "frame_ann": {"labels": [)" +
          label("wlak", R"(, "start_t": 0, "end_t": 2)") + "," + label("t-pose", R"(, "start_t": 2, "end_t": 3)") +
          R"(]}}, "2": {"babel_sid": 2, "url": "", "feat_p": "A/A/2.npz", "dur": 4.0, "frame_ann": null, "seq_ann": {"labels": [)" +
          label("sit", "") + "]}}}");
  ml::write_file(folder / "spelling.json", std::string_view(R"({"wlak": "walk"})"));
  CHECK(ml::babel_labels(folder / "babel.json", folder / "spelling.json") == std::vector<std::string>{"sit", "walk"});
}

TEST_CASE("tags of labels give the -ing form of any two of them") {
  const TemporaryFolder folder;
  ml::write_file(folder / "tags.txt", std::string_view("walk#walk/VERB#0.0#0.0\nwave hand#wave/VERB hand/NOUN#0.0#0.0\n"
                                                       "left hand up#left/ADJ hand/NOUN up/ADV#0.0#0.0\n"));
  const ml::LabelTags tags(folder / "tags.txt");
  using ml::Conjunction;
  const std::vector<std::string> two{"walk", "wave hand"}, turned{"wave hand", "walk"}, one{"walk"},
      no_verb{"walk", "left hand up"};
  CHECK(tags.join(two, Conjunction::while_) == "walk while waveing hand");  // as naive as published
  CHECK(tags.join(turned, Conjunction::during) == "wave hand during walking");
  CHECK(tags.join(no_verb, Conjunction::while_) == "walk while left hand up");
  CHECK(tags.join(one, Conjunction::while_) == "walk");
  CHECK(tags.join(two, Conjunction::same_time) == "walk and wave hand at the same time");
  const std::vector<std::string> unknown{"walk", "sit"};
  CHECK_ERROR(tags.join(unknown, Conjunction::while_), "no words of 'sit'");
  ml::DescribedMotion m{"1", "1", {}, {{"sit", {}}, {"walk", {}}}};
  CHECK_ERROR(tags.require({m}), "no words of 1 label:\nsit");
  m.texts.erase(m.texts.begin());
  CHECK_NOTHROW(tags.require({m}));
}
