/* SPDX-License-Identifier: MIT */
/* motionlang for programs in other languages: texts on a timeline in, 3D motion out, through plain C functions.
 *
 * Build    target motionlang::c of CMake, or: c++ -std=c++20 -O3 -fPIC -shared -fvisibility=hidden -I include
 *          -I /usr/include/eigen3 include/motionlang/c/motionlang_c.cpp -o libmotionlang_c.so
 * Motion   Y up, right-handed, metres, rotations as unit quaternions w x y z. Joint 0 is the root. A rest pose faces
 *          +Z; generated motion starts facing -Z.
 * Errors   Functions that can fail return 0 on success, otherwise an error id: one of core/error.hpp (101 ... 510),
 *          MOTIONLANG_CANCELLED or MOTIONLANG_FAILED. motionlang_message() then explains it. Nothing is thrown.
 * Memory   The caller owns the result of a function and frees it with motionlang_free_... Values are copied into
 *          memory of the caller.
 * Threads  Several threads may use one model or motion at the same time, as no function changes it. Do not free it
 *          while it is in use. */
#ifndef MOTIONLANG_C_H
#define MOTIONLANG_C_H

#include <stdint.h>

#if defined(MOTIONLANG_C_BUILD) && defined(_WIN32)
#define MOTIONLANG_C_API __declspec(dllexport)
#elif defined(MOTIONLANG_C_BUILD)
#define MOTIONLANG_C_API __attribute__((visibility("default")))
#else
#define MOTIONLANG_C_API
#endif

#ifdef __cplusplus
extern "C" {
#endif

#define MOTIONLANG_CANCELLED 1 /* the progress function stopped the work */
#define MOTIONLANG_FAILED 2    /* the system failed: no memory, ... */

typedef struct motionlang_model motionlang_model;
typedef struct motionlang_motion motionlang_motion;
typedef struct motionlang_motions motionlang_motions; /* several motions */
typedef struct motionlang_bytes motionlang_bytes;     /* the contents of a file */

/* The version of the library, MAJOR.MINOR.PATCH. */
MOTIONLANG_C_API const char* motionlang_version(void);
/* The reason of the last failure in this thread; "" if there was none. Valid until the next failure. */
MOTIONLANG_C_API const char* motionlang_message(void);
/* Sets the number of threads; the default is that of the machine. Error 101 below 1 or above 1024. */
MOTIONLANG_C_API int motionlang_set_threads(int32_t threads);

/* Reads a model: the weights that come with motionlang (examples/models/stmc_free.safetensors), what a train command of
 * the program writes, or the folder of a published STMC, MDM, MotionDiffuse, ACTOR, TEMOS, TMR, TEACH, SINC or TM2T. */
MOTIONLANG_C_API int motionlang_load_model(const char* file, motionlang_model** model);
/* The same of a published model that needs what is not beside it. text_encoder: a folder or a file of CLIP or
 * DistilBERT, for TM2T the folder of its word vectors; statistics: a folder with mean and std of the features. NULL:
 * beside the model. Error 102 if a model of ours is given one. */
MOTIONLANG_C_API int motionlang_load_model_with(const char* path, const char* text_encoder, const char* statistics,
                                                motionlang_model** model);
MOTIONLANG_C_API void motionlang_free_model(motionlang_model* model); /* NULL is allowed */
/* Frames per second of its motions. */
MOTIONLANG_C_API double motionlang_model_fps(const motionlang_model* model);
/* 1 if its texts are names or numbers of actions, as those of ACTOR: "walk # 0 # 3". Otherwise 0. */
MOTIONLANG_C_API int32_t motionlang_model_takes_actions(const motionlang_model* model);

/* Called after every step of denoising, by the thread that called motionlang_generate; 0 stops the work. */
typedef int32_t (*motionlang_progress)(void* user, int64_t done, int64_t total);

typedef struct motionlang_options {
  uint64_t seed;                /* same seed, same motion */
  int32_t steps;                /* of denoising; 0: the model's default */
  int32_t cut_texts;            /* 1: cut texts at the times where they lend body parts, and texts that are too long */
  int32_t smooth;               /* 1: remove jitter */
  int32_t fix_feet;             /* 1: stop standing feet from sliding */
  double guidance;              /* weight of the text; 1: no guidance; 0: the model's default */
  motionlang_progress progress; /* may be NULL */
  void* user;                   /* for progress */
  int32_t all_steps;            /* 1: all steps of the model; `steps` is ignored */
  const char* sampler;          /* "ddpm", "ddim" or "plms"; NULL: the model's */
  double overlap;               /* seconds that neighbouring texts share around a cut */
  const char* noise;            /* file with noise/000 (initial), noise/001, ... instead of the seed; may be NULL */
  const char* record;           /* file to write, which a later run can reuse; may be NULL */
  const char* reuse;  /* such a file: generates only the parts that an edit of the timeline changes, with the seed,
                                 * steps, ... of that run; may be NULL */
  double keep_beyond; /* of reuse: frames further from the edit, in seconds, stay as they were; 0: off */
  const motionlang_motion* keep; /* a motion to keep in part; the texts determine the rest; may be NULL */
  const double* keep_seconds;    /* of keep: (keep_stretches, 2), from and to */
  int64_t keep_stretches;        /* 0: keep the whole motion */
  const char* keep_parts; /* of keep: body parts, "legs, left arm"; the legs carry the path on the floor; NULL: all */
  int32_t fix_floor;      /* 1: the floor carries the body: no hovering, no sinking, flights are arcs */
  int32_t overlay_arms;   /* 1: an arm that loses its text moves as the text alone moves it; a second pass */
  const char* mode;       /* "stmc", or a baseline: "sinc", "sinc-lerp", "single-track", "one-text"; NULL: "stmc" */
} motionlang_options;
/* The defaults of `motionlang generate`: seed 0, the model's steps; cut texts, smooth motion, fixed feet and floor. */
MOTIONLANG_C_API motionlang_options motionlang_default_options(void);

/* The motion of a timeline, one text on a line: "walk forward # 0.0 # 6.0 # legs" (text # start # end in seconds # body
 * parts: left arm, right arm, legs, spine, head; none: the whole body). Models other than STMC, MDM, MotionDiffuse,
 * TEACH and SINC take one text alone. Errors 501 ... 510 have line and column. If options is NULL, the defaults
 * apply. */
MOTIONLANG_C_API int motionlang_generate(const motionlang_model* model, const char* timeline,
                                         const motionlang_options* options, motionlang_motion** motion);

/* The motion of one text or action for the whole body. seconds: 0 for the time that its action usually takes, or 5 if
 * the model does not know it. In a longer time an action that ends is made once, and what follows it is added, unless
 * cut_texts is 0 or `mode` is a baseline. The program's `generate --text` makes the same. */
MOTIONLANG_C_API int motionlang_generate_text(const motionlang_model* model, const char* text, double seconds,
                                              const motionlang_options* options, motionlang_motion** motion);

/* The motions of several timelines, which blank lines separate, or of a list of lines "text # duration". All are made
 * together; the noise of each depends on the seed and on its place. */
MOTIONLANG_C_API int motionlang_generate_motions(const motionlang_model* model, const char* timelines,
                                                 const motionlang_options* options, motionlang_motions** motions);

/* How much of an earlier motion a motion with `reuse` has. All fields of other motions are 0. */
typedef struct motionlang_reuse {
  int64_t frames, kept;     /* of the motion; those whose features are unchanged */
  int64_t work, whole_work; /* rows through the network; in a run without reuse */
  int32_t exact;            /* 1: the motion is that of a run without reuse, bit for bit */
} motionlang_reuse;
MOTIONLANG_C_API motionlang_reuse motionlang_motion_reuse(const motionlang_motion* motion);
/* A stretch of a motion, in seconds, that begins at `start` of the result. Until then the result holds the first frame.
 * With keep_seconds from `start` on it is kept there in a timeline. */
MOTIONLANG_C_API int motionlang_cut_motion(const motionlang_motion* motion, double from, double to, double start,
                                           motionlang_motion** result);

/* Texts that the model knows, as JSON: [{"text", "seconds", "repeats"}]. First come those that begin like a text that
 * somebody writes, then those with its words, then those nearest in meaning. NULL: any. `seconds` is how long
 * the action takes; if it repeats, it goes on for any time. Empty for a model without captions. */
MOTIONLANG_C_API int motionlang_known_texts(const motionlang_model* model, const char* begun, int64_t count,
                                            motionlang_bytes** json);
/* A timeline for an editor, as JSON: {"fps", "seconds", "texts": [{"text", "start", "end", "parts": ["legs"]}],
 * "warnings": [{"texts": [0], "message"}]}. Times are in seconds from the first start, and `texts` of a warning has the
 * numbers of the texts that it is about. Errors 501 ... 509 have line and column. */
MOTIONLANG_C_API int motionlang_check_timeline(const motionlang_model* model, const char* timeline,
                                               motionlang_bytes** json);

typedef struct motionlang_read_options {
  double scale;         /* metres per unit of a .bvh file */
  double fps;           /* for .glb, .gltf, .vrm and .vrma, whose keys have their own times; 0: their rate, or 30 */
  double rate;          /* for an .npy, .amc or .npz file without a rate; 0: the published one, 120 for .amc */
  int32_t up;           /* axis that points up, except for .npz: 'x', 'y' or 'z', negative (-'y') if its other end does;
                         * 0: 'y'; for positions in .npy: detected */
  int32_t drop_lead_in; /* 1: leave out a T-pose that an exporter put at the start */
  const char* asf;      /* skeleton of an .amc file; NULL: that of its subject beside it, or the only one there */
  const char* joints;   /* table of joints for retargeting to SMPL's joints; NULL: motions keep their own */
} motionlang_read_options;
/* BVH in centimetres; everything else is 0 or NULL. */
MOTIONLANG_C_API motionlang_read_options motionlang_default_read_options(void);

/* The motions of a file: .bvh (each ROOT), .amc, .npz (AMASS, smplx), .npy (joints, features, or all motions of MDM's
 * results.npy), .glb, .gltf, .vrm, .vrma (each animation). If options is NULL, the defaults apply. */
MOTIONLANG_C_API int motionlang_read_motions(const char* file, const motionlang_read_options* options,
                                             motionlang_motions** motions);
/* The same for a file in memory. The extension of `name` is its format. */
MOTIONLANG_C_API int motionlang_parse_motions(const void* bytes, int64_t size, const char* name,
                                              const motionlang_read_options* options, motionlang_motions** motions);
/* The first motion of a file, with the default options. */
MOTIONLANG_C_API int motionlang_read_motion(const char* file, motionlang_motion** motion);

MOTIONLANG_C_API int64_t motionlang_motions_count(const motionlang_motions* motions);
/* Belongs to the motions: do not free it. NULL: there is no such motion. */
MOTIONLANG_C_API const motionlang_motion* motionlang_motions_at(const motionlang_motions* motions, int64_t i);
/* A line for each property of the file that the motions lack (stretching bones, a T-pose in front); "" if nothing was
 * left out. */
MOTIONLANG_C_API const char* motionlang_motions_notes(const motionlang_motions* motions);
MOTIONLANG_C_API void motionlang_free_motions(motionlang_motions* motions); /* NULL is allowed */

/* Writes a .bvh, .glb, .vrma, .npz (AMASS) or .npy file (joint positions), a page (.html) or a film strip (.svg,
 * .png). */
MOTIONLANG_C_API int motionlang_write_motion(const motionlang_motion* motion, const char* file);
/* Writes several motions into one .glb (on one skeleton) or .html file. */
MOTIONLANG_C_API int motionlang_write_motions(const motionlang_motion* const* motions, int64_t count, const char* file);
/* Writes motions on the character of a GLB or VRM file. A .glb file is that file with the animations added, and an
 * .html file is a page that shows it. joints: a table of the character's joints; NULL: its skeleton is a known one. */
MOTIONLANG_C_API int motionlang_write_on_character(const motionlang_motion* const* motions, int64_t count,
                                                   const char* character, const char* joints, const char* file);
/* Writes the features of a system, (frames, width) as .npy, at its own rate: "guoh3d" (HumanML3D), "kit", "rifke"
 * (TMR), "smplrifke" (STMC), "actor", and the others of `motionlang info --features list`. The motion is on SMPL's
 * joints. Error 103 for another name and for other joints. */
MOTIONLANG_C_API int motionlang_write_features(const motionlang_motion* motion, const char* features, const char* file);
/* The contents of a file of one motion in memory. `kind` is its extension, ".glb". */
MOTIONLANG_C_API int motionlang_motion_bytes(const motionlang_motion* motion, const char* kind,
                                             motionlang_bytes** bytes);
/* The data that the page of a viewer draws, as JSON: the figure, the floor, and every frame. */
MOTIONLANG_C_API int motionlang_viewer_data(const motionlang_motion* motion, motionlang_bytes** json);
/* The same of a motion on the character of a GLB or VRM file in memory, which is retargeted: {"motion", "body"}. `name`
 * stands in messages. */
MOTIONLANG_C_API int motionlang_viewer_data_on(const motionlang_motion* motion, const void* character, int64_t size,
                                               const char* name, motionlang_bytes** json);
MOTIONLANG_C_API const void* motionlang_bytes_data(const motionlang_bytes* bytes);
MOTIONLANG_C_API int64_t motionlang_bytes_size(const motionlang_bytes* bytes);
MOTIONLANG_C_API void motionlang_free_bytes(motionlang_bytes* bytes); /* NULL is allowed */

/* The name of the file, its animation or its root, such as "walk"; valid as long as the motion. "" for NULL. */
MOTIONLANG_C_API const char* motionlang_motion_name(const motionlang_motion* motion);
/* The motion on the skeleton of another one, which was read from the file of a character: Mixamo, Unreal, VRM, CMU, ...
 * (joints by name). */
MOTIONLANG_C_API int motionlang_retarget(const motionlang_motion* motion, const motionlang_motion* character,
                                         motionlang_motion** result);
MOTIONLANG_C_API void motionlang_free_motion(motionlang_motion* motion); /* NULL is allowed */

MOTIONLANG_C_API int64_t motionlang_frames(const motionlang_motion* motion);
MOTIONLANG_C_API int32_t motionlang_joints(const motionlang_motion* motion);
MOTIONLANG_C_API double motionlang_fps(const motionlang_motion* motion);
/* Name of joint 0 ... joints-1 (NULL: no such joint), and its parent, which comes before it (-1: the root has none). */
MOTIONLANG_C_API const char* motionlang_joint_name(const motionlang_motion* motion, int32_t joint);
MOTIONLANG_C_API int32_t motionlang_joint_parent(const motionlang_motion* motion, int32_t joint);

/* Copies values into `room` floats. Error 205 unless `room` is exactly their number.
 *   offsets     (joints, 3): from the parent, in the rest pose
 *   root        (frames, 3): the positions of the root
 *   rotations   (frames, joints, 4): relative to the parent
 *   positions   (frames, joints, 3): in the world */
MOTIONLANG_C_API int motionlang_offsets(const motionlang_motion* motion, float* xyz, int64_t room);
MOTIONLANG_C_API int motionlang_root(const motionlang_motion* motion, float* xyz, int64_t room);
MOTIONLANG_C_API int motionlang_rotations(const motionlang_motion* motion, float* wxyz, int64_t room);
MOTIONLANG_C_API int motionlang_positions(const motionlang_motion* motion, float* xyz, int64_t room);

/* ---- Search: motions by words, or by another motion. ---- */

typedef struct motionlang_index motionlang_index; /* vectors of motions, with the model (TMR) that made them */
typedef struct motionlang_hits motionlang_hits;   /* the answer to a search, best first */

typedef struct motionlang_index_options {
  const char* model;            /* folder of TMR, such as examples/models/tmr_free, which needs stmc_free.safetensors
                                   beside it; NULL: that of the index */
  const char* text_encoder;     /* language model, for a TMR without word pieces of its own; may be NULL */
  const char* license;          /* of all motions; NULL: the first line of the LICENSE file beside or above them */
  int32_t moments;              /* in a new index: 1: also moments of 1, 2 and 3 seconds; 0: only whole clips */
  int32_t again;                /* 1: read all files, also unchanged ones */
  motionlang_progress progress; /* called after every few files; may be NULL */
  void* user;                   /* for progress */
} motionlang_index_options;
/* With moments; everything else is 0 or NULL. */
MOTIONLANG_C_API motionlang_index_options motionlang_default_index_options(void);

/* The report of an update: numbers of clips and files. */
typedef struct motionlang_index_report {
  int64_t clips;                       /* in the index now */
  int64_t added, removed;              /* clips */
  int64_t renamed, unchanged, skipped; /* files; clips that cannot be read or encoded */
} motionlang_index_report;

/* Makes the index of a folder of motions, or updates it: files that have not changed are not read again. If `progress`
 * stops the work, the file holds the part that is done. `report` may be NULL. */
MOTIONLANG_C_API int motionlang_update_index(const char* index_file, const char* folder,
                                             const motionlang_index_options* options, motionlang_index_report* report);
/* Opens an index with its model. model, text_encoder: their new places if they have moved, otherwise NULL. */
MOTIONLANG_C_API int motionlang_open_index(const char* index_file, const char* model, const char* text_encoder,
                                           motionlang_index** index);
MOTIONLANG_C_API int64_t motionlang_index_clips(const motionlang_index* index);
MOTIONLANG_C_API void motionlang_free_index(motionlang_index* index); /* NULL is allowed */

#define MOTIONLANG_SEARCH_CLIPS 0    /* whole clips */
#define MOTIONLANG_SEARCH_MOMENTS 1  /* windows of clips */
#define MOTIONLANG_SEARCH_CAPTIONS 2 /* the captions of clips, not their motion */

typedef struct motionlang_search_options {
  int64_t top;         /* number of hits */
  int32_t what;        /* MOTIONLANG_SEARCH_... */
  double most_overlap; /* intersection over union; a moment is left out if it overlaps a better one more than this */
} motionlang_search_options;
/* Ten clips; overlap 0.3. */
MOTIONLANG_C_API motionlang_search_options motionlang_default_search_options(void);

/* If options is NULL, the defaults apply. Error 102 for moments in an index without any. */
MOTIONLANG_C_API int motionlang_search_text(const motionlang_index* index, const char* text,
                                            const motionlang_search_options* options, motionlang_hits** hits);
MOTIONLANG_C_API int motionlang_search_motion(const motionlang_index* index, const motionlang_motion* motion,
                                              const motionlang_search_options* options, motionlang_hits** hits);

typedef struct motionlang_hit {
  const char* path;    /* of the file */
  const char* name;    /* of the motion, in a file with several; "" otherwise */
  const char* caption; /* the first one of the clip; "" if it has none */
  const char* license; /* "" if none is known */
  double start, end;   /* seconds in the file */
  double score;        /* 0 to 1. For a text and the bundled model: the share of pairs of a text and a motion of
                          something else that are farther apart */
} motionlang_hit;
MOTIONLANG_C_API int64_t motionlang_hits_count(const motionlang_hits* hits);
/* The texts belong to the hits. Error 203 if there is no such hit. */
MOTIONLANG_C_API int motionlang_hits_at(const motionlang_hits* hits, int64_t i, motionlang_hit* hit);
/* The motion of a hit, with up to `margin` seconds before and after it. stretch: where the hit begins and ends in the
 * result, in seconds; may be NULL. Error 401 if the file is gone. */
MOTIONLANG_C_API int motionlang_hits_motion(const motionlang_hits* hits, int64_t i, double margin, double stretch[2],
                                            motionlang_motion** motion);
/* 0: no clip shows the text, and the hits are only the nearest. Otherwise 1. */
MOTIONLANG_C_API int motionlang_hits_shown(const motionlang_hits* hits);
/* Words of the text that the model knows nothing about, with blanks between them; "" if there are none. They belong to
 * the hits. */
MOTIONLANG_C_API const char* motionlang_hits_unknown_words(const motionlang_hits* hits);
MOTIONLANG_C_API void motionlang_free_hits(motionlang_hits* hits); /* NULL is allowed */

#ifdef __cplusplus
}
#endif

#endif
