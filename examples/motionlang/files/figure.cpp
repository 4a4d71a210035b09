// motionlang figure: pictures as the papers have them, from timelines, motions, tables and texts.
#include <cstdio>

#include <motionlang/compose/cut_texts.hpp>
#include <motionlang/datasets/word_counts.hpp>
#include <motionlang/generate/timeline_tracks.hpp>
#include <motionlang/view/film_strip.hpp>
#include <motionlang/view/similarity_picture.hpp>
#include <motionlang/view/timeline_picture.hpp>
#include <motionlang/view/word_charts.hpp>

#include "../commands.hpp"
#include "../formatted.hpp"
#include "../generate/timelines.hpp"
#include "../option_checks.hpp"
#include "../search/search_model.hpp"
#include "motion_files.hpp"

namespace program {

namespace {

struct FigureCommand {
  std::vector<std::string> in;
  std::string out, timeline, colours = "part", model = default_search_model().string(), text_encoder;
  std::vector<std::string> texts, truth;
  double fps = 20, window = 1;
  int poses = 0;
  std::size_t most = 25;
  bool cut = false, rows = false;

  /// Writes the picture beside no input, and says so.
  void write(const std::string& svg) const {
    ml::InputFiles inputs{timeline};
    for (const std::string& file : in) inputs.add(file);
    inputs.refuse(out);
    ml::write_file(std::filesystem::path(out), svg);
    std::printf("%s\n", out.c_str());
  }
};

void draw_timelines(const FigureCommand& o) {
  auto timelines = read_timelines(o.in.at(0), o.fps);
  if (o.cut) {
    for (ml::Timeline& t : timelines) t = ml::cut_texts(t, o.fps);
  }
  o.write(ml::timelines_svg(timelines, o.fps));
}

void draw_bodies(const FigureCommand& o) {
  const ml::Motion motion = read_only_performed_motion(o.in.at(0));
  const auto timelines = read_timelines(o.timeline, o.fps);
  const auto colours = o.colours == "part" ? ml::StripColours::text_of_part : ml::StripColours::newest_text;
  o.write(ml::film_strip_svg(motion, ml::timeline_tracks(timelines.front(), o.fps),
                             {.poses = o.poses, .colours = colours}));
}

void draw_curves(const FigureCommand& o) {
  const std::string& file = o.in.at(0);
  o.write(ml::curves_svg(ml::parse_curves(read_timeline_text(file), o.rows, timeline_source(file))));
}

/// "2-4.5", seconds.
std::pair<double, double> range_of(const std::string& text) {
  const auto dash = text.find('-');
  double from = 0, to = 0;
  const bool good =
      dash != text.npos && std::sscanf(text.c_str(), "%lf-%lf", &from, &to) == 2 && 0 <= from && from < to;
  if (!good) ml::raise<usage_error>(101, "--truth '", text, "' is not a time range such as 2-4.5");
  return {from, to};
}
void draw_moments(const FigureCommand& o) {
  if (!o.truth.empty() && o.truth.size() != o.texts.size())
    ml::raise<usage_error>(102, "--truth has ", o.truth.size(), " ranges for ", counted(o.texts.size(), "text"));
  const ml::Motion motion = read_only_performed_motion(o.in.at(0));
  const SearchModel model = search_model(o.model, o.text_encoder);
  std::vector<ml::TextToLocate> texts;
  for (const std::string& text : o.texts) texts.push_back({text});
  for (std::size_t i = 0; i < o.truth.size(); ++i) texts[i].truth = range_of(o.truth[i]);
  const auto picture = ml::similarity_picture(model, texts, motion, o.window);
  print(picture.about);
  o.write(ml::curves_svg(picture.panels));
}

void draw_words(const FigureCommand& o) {
  std::vector<ml::NamedTexts> sets;
  for (const std::string& place : o.in) {
    auto [texts, phrases] = ml::texts_of_data(place);
    const auto path = std::filesystem::path(place).lexically_normal();
    const auto name = path.has_filename() ? path.filename() : path.parent_path().filename();  // "KIT-ML/" has none
    sets.push_back({name.string(), std::move(texts), std::move(phrases)});
  }
  const ml::WordCharts charts = ml::word_charts(sets, o.most);
  print(charts.about);
  const std::filesystem::path out(o.out);
  o.write(ml::curves_svg(std::span(&charts.words, 1)));
  FigureCommand verbs_of = o;
  verbs_of.out = (out.parent_path() / (out.stem().string() + "_verbs.svg")).string();
  verbs_of.write(ml::bar_chart_svg(charts.verbs));
}

/// A kind of figure: its inputs and the picture.
CLI::App* add_kind_of_figure(CLI::App& c, const std::shared_ptr<FigureCommand>& o, const char* name, const char* about,
                             const char* input, std::size_t most, void (*draw)(const FigureCommand&)) {
  CLI::App* kind = c.add_subcommand(name, about);
  kind->add_option("input", o->in, input)->required()->expected(1, static_cast<int>(most));
  kind->add_option("-o,--out", o->out, "The picture (.svg)")->required()->check(not_empty());
  kind->callback([o, draw] { draw(*o); });
  return kind;
}

}  // namespace

void add_figure(CLI::App& app) {
  const auto o = std::make_shared<FigureCommand>();
  CLI::App* c = app.add_subcommand("figure", "Draws figures of the papers as SVG");
  c->require_subcommand(1);
  const auto fps = [&](CLI::App* kind) {
    checked_option(*kind, "--fps", o->fps, positive(), "Frames per second of the timeline");
  };
  CLI::App* timelines =
      add_kind_of_figure(*c, o, "timelines", "Timelines, and the text that each body part follows (thesis, figure 6.5)",
                         "Timeline file; - reads standard input", 1, draw_timelines);
  fps(timelines);
  timelines->add_flag("--cut-texts", o->cut, "Cut texts first, as generate does");

  CLI::App* bodies = add_kind_of_figure(
      *c, o, "bodies", "A film strip in the colours of the texts (thesis, figure 6.7)", "Motion file", 1, draw_bodies);
  file_option(*bodies, "--timeline", o->timeline, "Timeline file of this motion")->required();
  fps(bodies);
  checked_option(*bodies, "--colours", o->colours, CLI::IsMember({"part", "newest"}),
                 "part: each body part has the colour of its own text; newest: the whole body has the colour of "
                 "the text that started last, as in the thesis");
  bodies->add_option("--poses", o->poses, "Number of poses. The default is as many as the motion needs")
      ->check(in_range(1, 200));

  CLI::App* curves = add_kind_of_figure(
      *c, o, "curves", "Curves of a table (thesis, figures 3.4, 3.5, 4.5, 5.10)",
      "Table; - reads standard input. Cells are separated by tabs or several blanks. The first line names the axis and "
      "the curves, and each other line has a value of the axis and of each curve, - for none. Lines with # are titles",
      1, draw_curves);
  curves->add_flag("--rows", o->rows, "Each line is a curve: its name and values. The first line has the axis");

  CLI::App* moments =
      add_kind_of_figure(*c, o, "moments", "The similarity of texts and a motion over time (thesis, figures 5.8, 5.9)",
                         "Motion file", 1, draw_moments);
  moments->add_option("--text", o->texts, "A text; may be given several times")->required()->check(utf8());
  moments->add_option("--truth", o->truth, "For each text the seconds in which the motion shows it, such as 2-4.5");
  checked_option(*moments, "--window", o->window, positive(), "Seconds around each frame that are compared");
  path_option(*moments, "--model", o->model, "TMR, of train-tmr or published. The default is the bundled one");
  path_option(*moments, "--text-encoder", o->text_encoder, "Its language model, if it reads the states of one");

  CLI::App* words = add_kind_of_figure(
      *c, o, "words",
      "Words and verbs of data sets (thesis, figure A.3). Writes NAME.svg (words by how often they appear) and "
      "NAME_verbs.svg",
      "Tables of captions, .json files of annotations or of BABEL, or folders in the form of HumanML3D or KIT-ML, "
      "whose action phrases are counted, too",
      8, draw_words);
  checked_option(*words, "--most", o->most, in_range(1, 1000), "Number of verbs");
}

}  // namespace program
