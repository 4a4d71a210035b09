// motionlang search: finds the motions of an index that fit words or another motion.
#include <cstdio>
#include <optional>

#include <motionlang/kinematics/edit_motion.hpp>
#include <motionlang/search/query_bench.hpp>
#include <motionlang/train/shared_search.hpp>
#include <motionlang/view/search_page.hpp>

#include "../commands.hpp"
#include "../files/motion_files.hpp"
#include "../formatted.hpp"
#include "../machine_options.hpp"
#include "../option_checks.hpp"
#include "../train/processes.hpp"
#include "search_model.hpp"

namespace program {

namespace {

using ml::Index;

struct SearchOptions {
  std::string index, text, like, model, text_encoder, html, queries;
  double from = 0, to = 0, overlap = 0.3;
  Index top = 10;
  bool moments = false, captions = false, json = false, exact = false;
  MotionReadOptions read;
  MachineOptions machine;

  ml::SearchOptions search() const {
    return {.top = top,
            .what = moments    ? ml::SearchFor::moments
                    : captions ? ml::SearchFor::captions
                               : ml::SearchFor::clips,
            .most_overlap = overlap,
            .exact = exact,
            .storage = machine.precision == "bf16" ? ml::ScanStorage::bfloat16 : ml::ScanStorage::float32};
  }
};

class Search {
 public:
  explicit Search(const SearchOptions& options) : o_(options) {
    processes();  // all but the first print nothing
    if (std::filesystem::is_directory(o_.index))
      shards_ = ml::IndexShards::open(o_.index), tables_ = shards_;
    else
      file_ = ml::MotionIndexFile::open(o_.index), tables_ = std::make_shared<ml::TablesOfIndex>(file_->index());
  }

  void run() {
    if (!o_.queries.empty()) {
      if (!o_.text.empty()) ml::raise<usage_error>(102, "search: give either a text or --queries");
      std::optional<ml::MotionIndex> whole;
      if (shards_) whole = shards_->whole();
      const ml::MotionIndex& all = whole ? *whole : file_->index();
      return print(ml::describe_query_answers(ml::answer_queries(all, model(), ml::read_queries(o_.queries))));
    }
    if (o_.text.empty() == o_.like.empty())
      ml::raise<usage_error>(102, "search: give either a text or --like with a motion file");
    if (o_.moments && o_.captions)
      ml::raise<usage_error>(102, "search: --moments and --captions are two different searches");
    if (!o_.html.empty()) require_folder_of(o_.html);
    ml::InputFiles{o_.index, o_.like}.refuse(o_.html);
    answer_ = answer();
    found_ = ml::found_motions(*tables_, answer_);
    print(o_.json ? ml::search_json(found_, answer_, query_text(), kind()) : ml::search_text(found_, answer_, one()));
    if (!o_.json && found_.empty()) std::printf("no results: the index has %td %s\n", gallery(), kind());
    if (!o_.html.empty() && processes().rank() == 0) write_page();
  }

 private:
  SearchModel model() const {
    const ml::IndexModel& made_with = tables_->model();
    const std::string path = o_.model.empty() ? made_with.path : o_.model;
    SearchModel out = search_model(path, o_.text_encoder.empty() ? made_with.text_encoder : o_.text_encoder);
    ml::MotionIndex(made_with).require_model(out.model().id, path);
    return out;
  }
  ml::TextAnswer answer() const {
    const SearchModel model = this->model();
    const ml::SearchOptions how = o_.search();
    const ml::MotionSearch moves =
        shards_ ? ml::open_shared_search(shards_, processes()) : ml::open_motion_search(*file_, how.exact, how.storage);
    if (!o_.text.empty()) return ml::answer_text(moves, model, o_.text, how);
    const ml::Motion like = ml::edit_time(read_motions(o_.like, o_.read).front(), {.from = o_.from, .to = o_.to});
    ml::TextAnswer out{.hits = ml::search(moves, ml::encode_motion(model, like), how)};
    for (const ml::MotionHit& h : out.hits) out.scores.push_back(ml::score_of(h));
    return out;
  }

  const char* one() const { return o_.moments ? "moment" : "clip"; }
  const char* kind() const { return o_.moments ? "moments" : o_.captions ? "captions" : "clips"; }
  /// The number of items to search.
  Index gallery() const { return ml::gallery_size(*tables_, o_.search().what); }
  std::string query_text() const { return o_.text.empty() ? "like " + o_.like : o_.text; }

  void write_page() {
    ml::draw_found(found_, o_.read);
    for (ml::FoundMotion& f : found_) f.problem = with_options(f.problem);
    const std::string summary = ml::concat_text(answer_.shown ? "" : ml::concat_text("No ", one(), " shows this. "),
                                                "The nearest ", kind(), " of ", gallery(), " in ", o_.index);
    ml::write_file(o_.html, ml::search_html(found_, query_text(), summary));
    if (!o_.json)
      std::printf("Open %s in a browser to see them.\n", std::filesystem::absolute(o_.html).string().c_str());
  }

  const SearchOptions& o_;
  std::optional<ml::MotionIndexFile> file_;
  std::shared_ptr<const ml::IndexShards> shards_;  // instead
  std::shared_ptr<const ml::IndexTables> tables_;  // of either
  ml::TextAnswer answer_;
  std::vector<ml::FoundMotion> found_;
};

}  // namespace

void add_search(CLI::App& app) {
  const auto o = std::make_shared<SearchOptions>();
  CLI::App* c = app.add_subcommand("search", "Finds the motions of an index that fit a text or another motion");
  path_option(*c, "index", o->index, "File or folder of shards written by motionlang index")->required();
  c->add_option("text", o->text, "Text to search for, such as \"a person waves with the left hand\"");
  CLI::Option* like =
      file_option(*c, "--like", o->like, "Motion to search for instead of a text: .bvh, .amc, .npz (AMASS) or .glb");
  c->add_option("--from", o->from, "Start of that motion in seconds")->check(not_negative())->needs(like);
  c->add_option("--to", o->to, "End of that motion in seconds")->check(positive())->needs(like);
  CLI::Option* moments = c->add_flag("--moments", o->moments, "Search moments of clips instead of whole clips");
  c->add_flag("--captions", o->captions, "Compare with the captions of clips instead of their motion");
  checked_option(*c, "--top", o->top, in_range(1, 100000), "Number of results");
  c->add_option(
       "--overlap", o->overlap,
       "Leave out moments that overlap a better moment of the same clip by more than this (intersection over union)")
      ->check(in_range(0, 1))
      ->needs(moments)
      ->capture_default_str();
  file_option(*c, "--queries", o->queries,
              "Instead of a text: a table of queries and of phrases in the captions of right results. Prints how "
              "often the first result is right (examples/training/queries.tsv)")
      ->excludes(like)
      ->excludes(moments);
  c->add_option("--html", o->html, "HTML page with film strips of the results");
  c->add_flag("--exact", o->exact, "Compare with all vectors, even if the index has a graph");
  c->add_flag("--json", o->json, "Print the result as JSON");
  folder_option(*c, "--model", o->model, "Folder of the model, if it has moved since the index was made");
  path_option(*c, "--text-encoder", o->text_encoder, "Language model, if it has moved since the index was made");
  o->read.add_to(*c);
  o->machine.add_to(*c);
  c->callback([o] {
    o->machine.apply();
    Search(*o).run();
  });
}

}  // namespace program
