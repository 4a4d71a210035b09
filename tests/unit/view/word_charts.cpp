// Charts of the words of data sets, by hand.
#include <doctest/doctest.h>

#include <motionlang/view/word_charts.hpp>

namespace ml = motionlang;

TEST_CASE("words by how often they appear, and the verbs that most texts have") {
  const std::vector<ml::NamedTexts> sets{{"a", {"walk slowly", "walk", "sit down slowly"}},
                                         {"b", {"a person sits"}, {"sit"}}};
  const ml::WordCharts charts = ml::word_charts(sets);
  REQUIRE(charts.words.curves.size() == 2);
  const ml::Curve& a = charts.words.curves[0];
  CHECK(a.name == "a");
  REQUIRE(a.values.size() == 50);
  CHECK(a.steps[1] == 2);
  CHECK(a.values[0] == 4);  // walk, slowly, sit, down
  CHECK(a.values[1] == 2);  // walk, slowly
  CHECK(a.values[2] == 0);
  CHECK(charts.verbs.series == std::vector<std::string>{"a", "b"});
  REQUIRE(charts.verbs.groups.size() == 2);  // of two texts each
  for (const ml::BarGroup& g : charts.verbs.groups)
    CHECK(g.values == (g.name == "walk" ? std::vector<double>{2, 0} : std::vector<double>{1, 1}));
  CHECK(charts.about ==
        "a: 3 texts, 4 words, 2 verbs\nb: 1 text, 3 words, 1 verb; 1 action phrase, 1 time on average; 'sit' "
        "most often, 1 time; 1 less than ten times, 1 once\n");
  CHECK(ml::word_charts(sets, 1).verbs.groups.size() == 1);
  CHECK(ml::word_charts({}).words.curves.empty());
}

TEST_CASE("verbs with as many texts are in alphabetical order") {
  ml::NamedTexts set{.name = "a", .texts = {"walk", "walk on"}};
  std::vector<std::string> expected{"walk"};
  for (char c = 'z'; c >= 'a'; --c) set.texts.emplace_back(3, c);
  for (char c = 'a'; c <= 'z'; ++c) expected.emplace_back(3, c);
  const auto groups = ml::word_charts(std::vector<ml::NamedTexts>{set}, 100).verbs.groups;
  std::vector<std::string> names;
  for (const ml::BarGroup& g : groups) names.push_back(g.name);
  CHECK(names == expected);
}
