/* Search from C: an index of a folder of motions, asked in words.
 *   usage: 09_c_search [model.safetensors [folder of TMR]]
 * The motions are made here, so that the example needs no files; yours are BVH, AMC, AMASS, glTF or NumPy files. */
#include <stdio.h>
#include <string.h>

#include <motionlang/c/motionlang_c.h>

#if defined(_WIN32)
#include <direct.h>
#define make_folder(name) _mkdir(name)
#else
#include <sys/stat.h>
#define make_folder(name) mkdir(name, 0777)
#endif

static int failed(const char* what) {
  fprintf(stderr, "%s: %s\n", what, motionlang_message());
  return 1;
}

static const char* last_part(const char* path) {
  const char* slash = strrchr(path, '/');
  return slash == NULL ? path : slash + 1;
}

/* Makes the motion of a text and writes it. Returns 0 on success. */
static int write_clip(const motionlang_model* model, const char* text, const char* file) {
  char timeline[256];
  motionlang_motion* motion = NULL;
  snprintf(timeline, sizeof timeline, "%s # 0 # 4\n", text);
  int status = motionlang_generate(model, timeline, NULL, &motion);
  if (status == 0) status = motionlang_write_motion(motion, file);
  motionlang_free_motion(motion);
  return status;
}

static int32_t go_on(void* user, int64_t done, int64_t total) {
  (void)done;
  *(int64_t*)user = total;
  return 1;
}

int main(int argc, char** argv) {
  motionlang_model* model = NULL;
  if (motionlang_load_model(argc > 1 ? argv[1] : MOTIONLANG_DEFAULT_MODEL, &model) != 0) return failed("model");
  make_folder("c_search");
  if (write_clip(model, "walk forward", "c_search/walk.bvh") != 0 ||
      write_clip(model, "raise both arms", "c_search/arms.npz") != 0 ||
      write_clip(model, "sit down", "c_search/sit.glb") != 0)
    return failed("write_clip");
  motionlang_free_model(model);

  int64_t files = 0;
  motionlang_index_options how = motionlang_default_index_options();
  how.model = argc > 2 ? argv[2] : MOTIONLANG_DEFAULT_TMR;
  how.again = 1, how.progress = go_on, how.user = &files;
  motionlang_index_report report;
  if (motionlang_update_index("c_search.index", "c_search", &how, &report) != 0) return failed("update");
  printf("%d files, %d clips, %d skipped\n", (int)files, (int)report.clips, (int)report.skipped);

  motionlang_index* index = NULL;
  if (motionlang_open_index("c_search.index", NULL, NULL, &index) != 0) return failed("open");
  const char* const questions[] = {"a person walks forward", "a person raises both arms", "a person sits down"};
  for (int q = 0; q < 3; ++q) {
    motionlang_hits* hits = NULL;
    motionlang_search_options options = motionlang_default_search_options();
    options.top = 1;
    if (motionlang_search_text(index, questions[q], &options, &hits) != 0) return failed("search");
    motionlang_hit best;
    if (motionlang_hits_at(hits, 0, &best) != 0) return failed("hit");
    printf("%s: %s\n", questions[q], last_part(best.path));
    motionlang_free_hits(hits);
  }

  /* The same with a motion instead of words: the nearest to a motion is the motion itself. */
  motionlang_motion* sit = NULL;
  motionlang_hits* like = NULL;
  if (motionlang_read_motion("c_search/sit.glb", &sit) != 0) return failed("read");
  if (motionlang_search_motion(index, sit, NULL, &like) != 0) return failed("search");
  motionlang_hit best;
  if (motionlang_hits_at(like, 0, &best) != 0) return failed("hit");
  printf("like sit.glb: %s, score %.2f, then %d others\n", last_part(best.path), best.score,
         (int)motionlang_hits_count(like) - 1);
  motionlang_free_hits(like);
  motionlang_free_motion(sit);
  motionlang_free_index(index);
  return 0;
}
