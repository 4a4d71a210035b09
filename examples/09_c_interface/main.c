/* The bundled model from C, as any language that can call C does it: load, generate, take the values, write a file.
 *   usage: 09_c_interface [model.safetensors] */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include <motionlang/c/motionlang_c.h>

static int failed(const char* what) {
  fprintf(stderr, "%s: %s\n", what, motionlang_message());
  return 1;
}

static int32_t count_steps(void* user, int64_t done, int64_t total) {
  (void)done, (void)total;
  ++*(int*)user;
  return 1; /* go on */
}

int main(int argc, char** argv) {
  const char* file = argc > 1 ? argv[1] : MOTIONLANG_DEFAULT_MODEL;
  motionlang_model* model = NULL;
  motionlang_motion* motion = NULL;
  if (motionlang_load_model(file, &model) != 0) return failed(file);

  int steps = 0;
  motionlang_options options = motionlang_default_options();
  options.seed = 7, options.progress = count_steps, options.user = &steps;
  const char* timeline =
      "walk forward    # 0.0 # 4.0 # legs\n"
      "raise both arms # 1.0 # 3.5 # left arm # right arm\n";
  if (motionlang_generate(model, timeline, &options, &motion) != 0) return failed("generate");

  const int64_t frames = motionlang_frames(motion), joints = motionlang_joints(motion), count = frames * joints * 3;
  float* positions = malloc((size_t)count * sizeof(float)); /* (frames, joints, 3) */
  if (positions == NULL || motionlang_positions(motion, positions, count) != 0) return failed("positions");
  const float *first = positions, *last = positions + (frames - 1) * joints * 3; /* joint 0 is the root */
  printf("%d frames of %d joints at %.0f per second\n", (int)frames, (int)joints, motionlang_fps(motion));
  printf("told of its steps: %s\n", steps > 0 ? "yes" : "no");
  printf("walked more than 2 m: %s\n", hypot(last[0] - first[0], last[2] - first[2]) > 2 ? "yes" : "no");

  if (motionlang_write_motion(motion, "c_interface.bvh") != 0) return failed("write");
  printf("wrote c_interface.bvh\n");

  /* An error is reported, not thrown. */
  motionlang_motion* none = NULL;
  const int id = motionlang_generate(model, "wave # 2 # 1\n", NULL, &none);
  printf("error %d: %s\n", id, motionlang_message());

  free(positions);
  motionlang_free_motion(motion);
  motionlang_free_model(model);
  return 0;
}
