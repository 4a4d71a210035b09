// motionlang index: makes a file from a folder of motions, in which `motionlang search` finds them by words.
#include <cmath>
#include <cstdio>

#include <motionlang/search/kept_index.hpp>
#include <motionlang/train/shared_index.hpp>

#include "../commands.hpp"
#include "../files/motion_files.hpp"
#include "../formatted.hpp"
#include "../machine_options.hpp"
#include "../option_checks.hpp"
#include "../progress_bar.hpp"
#include "../train/processes.hpp"
#include "search_model.hpp"

namespace program {

namespace {

namespace fs = std::filesystem;
using ml::Index;

struct IndexOptions {
  std::string folder, model, out, text_encoder, captions, license;
  std::vector<std::string> remove;
  std::vector<double> windows{1, 2, 3};  // seconds
  double stride = 0.5;
  bool windows_given = false;  // true also if the stride is given
  bool no_moments = false, again = false, list = false;
  MotionReadOptions read;
  MachineOptions machine;
  Index graph = 100'000;
  double shard_mib = 0;  // 0: one file
  bool check = false;
};

class Indexer {
 public:
  explicit Indexer(const IndexOptions& options)
      : o_(options), kept_(o_.out, o_.graph, std::llround(o_.shard_mib * (1 << 20))) {}

  void run() {
    if (o_.folder.empty() && !o_.list && !o_.check && o_.remove.empty())
      ml::raise<usage_error>(102, "index: name a folder of motions, --list, --check or --remove");
    if (!kept_.has_index() && (o_.folder.empty() || !o_.remove.empty()))
      ml::raise<ml::io_error>(401, "index: there is no ", o_.out, " yet");
    require_folder_of(o_.out);
    remove();
    if (!o_.folder.empty()) update();
    if (o_.check) check();
    if (o_.list) print(ml::listed_clips(kept_.store().clips()));
  }

 private:
  // ---- removing

  void remove() {
    if (o_.remove.empty()) return;
    Index removed = 0;
    for (const std::string& path : o_.remove) {
      const Index now = ml::remove_below(kept_.store(), path);
      if (now == 0) std::fprintf(stderr, "%s is not in the index\n", ml::printable(path).c_str());
      removed += now;
    }
    if (removed == 0 && o_.folder.empty() && !o_.list)
      ml::raise<usage_error>(103, "--remove: ", o_.out, " has none of these clips");
    if (removed == 0) return;
    const bool stopped = write();
    std::printf("%s: %s removed, %td left\n", o_.out.c_str(), ml::counted(removed, "clip").c_str(),
                kept_.store().count());
    if (stopped) throw ml::cancelled();
  }
  // ---- adding

  void update() {
    const fs::path folder = ml::indexed_path(o_.folder);
    ml::IndexOptions options{.license = o_.license, .again = o_.again, .read = o_.read};
    if (!o_.captions.empty()) options.captions = ml::read_captions(o_.captions, folder);
    const SearchModel model =
        search_model(kept_.model_path(o_.model, default_search_model()), kept_.text_encoder(o_.text_encoder));
    const ml::MomentOptions moments{.windows = o_.no_moments ? std::vector<double>{} : o_.windows, .stride = o_.stride};
    kept_.take_model(model, o_.windows_given || o_.no_moments ? &moments : nullptr);
    for (const std::string& place : {model.model().path, model.model().text_encoder})
      ml::text_of_first(processes(), place);
    ml::SharedFileEncoder encoder(processes(), model, kept_.store().model(), o_.read);
    ml::IndexUpdate update(kept_.store(), folder, model, std::move(options));
    const ml::IndexReport& report = update.report();
    std::fputs(report.folder_notes.c_str(), stderr);
    if (update.files() == 0)
      std::fprintf(stderr, "no .bvh, .amc, .npz, .npy, .glb or .vrma file below %s\n", folder.string().c_str());
    bool stopped = !all_of(update, encoder);
    if (kept_.needs_writing(report)) {
      if (stopped)
        kept_.write_without_graphs();
      else
        stopped = write();
    }
    for (const std::string& problem : report.skipped)
      std::fprintf(stderr, "skipped: %s\n", ml::printable(with_options(problem)).c_str());
    print(o_.out + ": " + ml::describe_update(kept_.store().count(), kept_.store().moment_count(), report));
    if (stopped) throw ml::cancelled();  // the vectors so far are kept
    for (const std::string& clip : report.unknown_clips)
      std::fprintf(stderr, "%s: there is no clip '%s' below %s\n", o_.captions.c_str(), ml::printable(clip).c_str(),
                   folder.string().c_str());
  }

  /// A file was checked when it was opened.
  void check() {
    if (ml::is_shard_folder(o_.out)) {
      ProgressBar bar("checking");
      ml::IndexShards::open(o_.out)->check(bar);
    }
    std::printf("%s: all bytes are as they were written\n", o_.out.c_str());
  }

  /// Returns false after Ctrl-C.
  static bool all_of(ml::IndexUpdate& update, ml::FileEncoder& encoder) {
    try {
      ProgressBar bar("indexing");
      update.run(bar, &encoder);
      return true;
    } catch (const ml::cancelled&) {
      return false;
    }
  }

  /// Returns true after Ctrl-C.
  bool write() {
    if (kept_.lacks_hnswlib())
      std::fprintf(stderr, "no graph: this program was built without hnswlib (libhnswlib-dev); searches compare all\n");
    ProgressBar bar("connecting");
    return kept_.write(bar);
  }

  const IndexOptions& o_;
  ml::KeptIndex kept_;
};

/// The work of a process that is not the first one: it encodes what that one sends.
void help(const IndexOptions& o) {
  if (o.folder.empty()) return;
  const std::string model = ml::text_of_first(processes(), ""), text_encoder = ml::text_of_first(processes(), "");
  ml::encode_for_first(processes(), search_model(model, text_encoder), o.read);
}

}  // namespace

void add_index(CLI::App& app) {
  const auto o = std::make_shared<IndexOptions>();
  CLI::App* c =
      app.add_subcommand("index", "Makes or updates an index, in which motionlang search finds motions by words");
  folder_option(*c, "folder", o->folder,
                "Folder with .bvh, .amc, .npz (AMASS), .npy (joints or features), .glb and .vrma files, including its "
                "subfolders. Unchanged files are not read again");
  c->add_option("-o,--out", o->out, "Index file, or folder of shards")->required();
  c->add_option("--shard-mib", o->shard_mib,
                "Write a folder of files of at most this size in MiB, for an index that is larger than memory. search "
                "finds the same in it as in one file")
      ->check(in_range(0.015625, 1 << 20));
  folder_option(*c, "--model", o->model,
                "Folder of a TMR, from train-tmr or as published. The default is the model of the index; a new index "
                "takes the bundled model");
  path_option(*c, "--text-encoder", o->text_encoder,
              "Language model that the model reads, if it has no word pieces of its own: a folder, or a cache (.npy)");
  file_option(*c, "--captions", o->captions, "Table of clip parts and their captions (examples/training/README.md)");
  c->add_option("--license", o->license,
                "Licence of the motions below the folder, including those already indexed. The default is the first "
                "line of the LICENSE file beside or above them; without such a file, the entry of the index stays");
  const CLI::Option* windows = c->add_option("--windows", o->windows, "Lengths of moments in seconds")
                                   ->delimiter(',')
                                   ->check(in_range(0.05, 600))
                                   ->capture_default_str();
  const CLI::Option* stride =
      checked_option(*c, "--stride", o->stride, in_range(0.05, 600), "Seconds from one moment to the next");
  c->add_flag("--no-moments", o->no_moments, "Index whole clips only, which is smaller and faster");
  c->add_flag("--again", o->again, "Read all files, even unchanged ones");
  c->add_flag("--check", o->check, "Read every byte of the index, and report the first that is wrong");
  c->add_option("--remove", o->remove, "Files or folders whose clips are removed from the index");
  c->add_flag("--list", o->list, "List the clips: path, start, end, frames per second, frames, captions, license");
  o->read.add_to(*c);
  checked_option(
      *c, "--graph", o->graph, positive(),
      "From this number of clips or moments on, searches follow a graph instead of comparing all vectors. The "
      "graph finds most of the nearest ones. Additions extend it; removals rebuild it");
  o->machine.add_to(*c);
  c->callback([=] {
    o->windows_given = windows->count() + stride->count() > 0;
    o->machine.apply();
    if (processes().rank() > 0)
      help(*o);
    else
      Indexer(*o).run();
  });
}

}  // namespace program
