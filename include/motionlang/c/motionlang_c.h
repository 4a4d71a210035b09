/* SPDX-License-Identifier: MIT */
/* motionlang for programs in other languages: texts on a timeline in, 3D motion out, through plain C functions.
 *
 * Build    target motionlang::c of CMake, or: c++ -std=c++20 -O3 -fPIC -shared -fvisibility=hidden -I include
 *          -I /usr/include/eigen3 include/motionlang/c/motionlang_c.cpp -o libmotionlang_c.so
 * Motion   Y up, right-handed, metres, rotations as unit quaternions w x y z. Joint 0 is the root. A rest pose faces
 *          +Z; generated motion starts facing -Z.
 * Errors   Functions that can fail return 0 on success, otherwise an error id: one of core/error.hpp (101 ... 510),
 *          MOTIONLANG_CANCELLED or MOTIONLANG_FAILED. motionlang_message() then says what is wrong. Nothing is thrown.
 * Memory   What a function makes belongs to the caller until motionlang_free_... is called for it. Values are copied
 *          into memory of the caller.
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

#define MOTIONLANG_CANCELLED 1 /* the progress function said so */
#define MOTIONLANG_FAILED 2    /* the system did: no memory, ... */

typedef struct motionlang_model motionlang_model;
typedef struct motionlang_motion motionlang_motion;
typedef struct motionlang_motions motionlang_motions; /* several of them */
typedef struct motionlang_bytes motionlang_bytes;     /* the contents of a file */

/* The version of the library, MAJOR.MINOR.PATCH. */
MOTIONLANG_C_API const char* motionlang_version(void);
/* Why the last function of this thread that failed did; "" if none has. Valid until the next one fails. */
MOTIONLANG_C_API const char* motionlang_message(void);
/* Threads that calculate; as many as the machine has unless said. 101 below 1 or above 1024. */
MOTIONLANG_C_API int motionlang_set_threads(int32_t threads);

/* Reads a model: the weights that come with motionlang (examples/models/stmc_free.safetensors), or those that
 * `motionlang train` writes. */
MOTIONLANG_C_API int motionlang_load_model(const char* file, motionlang_model** model);
MOTIONLANG_C_API void motionlang_free_model(motionlang_model* model); /* of NULL: nothing */
/* Frames per second of its motions. */
MOTIONLANG_C_API double motionlang_model_fps(const motionlang_model* model);

/* Called after every step of denoising, by the thread that called motionlang_generate; 0 stops the work. */
typedef int32_t (*motionlang_progress)(void* user, int64_t done, int64_t total);

typedef struct motionlang_options {
  uint64_t seed;                /* same seed, same motion */
  int32_t steps;                /* of denoising; 0: as many as the model wants */
  int32_t cut_texts;            /* 1: texts are cut where they lend body parts, and into parts where they are long */
  int32_t smooth;               /* 1: without jitter */
  int32_t fix_feet;             /* 1: feet that stand do not slide */
  double guidance;              /* weight of the text, 1: without guidance; 0: what the model wants */
  motionlang_progress progress; /* may be NULL */
  void* user;                   /* for progress */
  int32_t all_steps;            /* 1: all steps that the model has, whatever `steps` says */
  const char* sampler;          /* "ddpm" or "ddim"; NULL: what the model wants */
  double overlap;               /* seconds that neighbouring texts share around a cut */
  const char* noise;            /* file with noise/000 (initial), noise/001, ... instead of the seed; may be NULL */
  const char* record;           /* file to write, which a later run can reuse; may be NULL */
  const char* reuse;  /* such a file: only what an edit of the timeline changes is made anew, with the seed, the
                                 * steps, ... of that run; may be NULL */
  double keep_beyond; /* of reuse: what is further from the edit, in seconds, stays as it was; 0: nothing does */
  const motionlang_motion* keep; /* a motion of which something is kept, the texts make the rest; may be NULL */
  const double* keep_seconds;    /* of keep: (keep_stretches, 2), from and to */
  int64_t keep_stretches;        /* 0: all of it is kept */
  const char* keep_parts; /* of keep: body parts, "legs, left arm"; the legs have the way over the ground; NULL: all */
} motionlang_options;
/* What the program `motionlang generate` does: seed 0, all that the model wants, cut, smooth, feet fixed. */
MOTIONLANG_C_API motionlang_options motionlang_default_options(void);

/* The motion of a timeline, one text on a line: "walk forward # 0.0 # 6.0 # legs" (text # start # end in seconds # body
 * parts: left arm, right arm, legs, spine, head; none: the whole body). Errors 501 ... 510 have line and column. The
 * default options are taken where options is NULL. */
MOTIONLANG_C_API int motionlang_generate(const motionlang_model* model, const char* timeline,
                                         const motionlang_options* options, motionlang_motion** motion);

/* The motions of several timelines, which blank lines separate, or of a list of lines "text # duration". All are made
 * together; the noise of each depends on the seed and on its place. */
MOTIONLANG_C_API int motionlang_generate_motions(const motionlang_model* model, const char* timelines,
                                                 const motionlang_options* options, motionlang_motions** motions);

typedef struct motionlang_read_options {
  double scale;         /* metres per unit of a .bvh file */
  double fps;           /* of .glb, .gltf, .vrm and .vrma, whose keys have times of their own; 0: their rate, or 30 */
  double rate;          /* of an .npy, .amc or .npz file that has none; 0: as published, 120 for .amc */
  int32_t up;           /* axis of an .npy file with positions that points up: 'y' or 'z'; 0: found */
  int32_t drop_lead_in; /* 1: without a T-pose that an exporter put in front */
  const char* asf;      /* skeleton of an .amc file; NULL: that of its subject beside it, or the only one there */
  const char* joints;   /* table of joints by which motions are put on SMPL's; NULL: they stay on their own */
} motionlang_read_options;
/* Centimetres, everything else 0 or NULL. */
MOTIONLANG_C_API motionlang_read_options motionlang_default_read_options(void);

/* The motions of a file: .bvh (each ROOT), .amc, .npz (AMASS, smplx), .npy (joints, features, or all motions of MDM's
 * results.npy), .glb, .gltf, .vrm, .vrma (each animation). The default options are taken where options is NULL. */
MOTIONLANG_C_API int motionlang_read_motions(const char* file, const motionlang_read_options* options,
                                             motionlang_motions** motions);
/* The same of a file in memory: the extension of `name` says which format it is. */
MOTIONLANG_C_API int motionlang_parse_motions(const void* bytes, int64_t size, const char* name,
                                              const motionlang_read_options* options, motionlang_motions** motions);
/* The first of them, with the default options. */
MOTIONLANG_C_API int motionlang_read_motion(const char* file, motionlang_motion** motion);

MOTIONLANG_C_API int64_t motionlang_motions_count(const motionlang_motions* motions);
/* Belongs to the motions: do not free it. NULL: there is no such motion. */
MOTIONLANG_C_API const motionlang_motion* motionlang_motions_at(const motionlang_motions* motions, int64_t i);
/* A line for each thing that the file has and the motions lack (bones that stretch, a T-pose in front); "" if nothing
 * was left out. */
MOTIONLANG_C_API const char* motionlang_motions_notes(const motionlang_motions* motions);
MOTIONLANG_C_API void motionlang_free_motions(motionlang_motions* motions); /* of NULL: nothing */

/* Into a .bvh, .glb, .npz (AMASS) or .npy file (joint positions), a page to look at (.html) or a film strip (.svg,
 * .png). */
MOTIONLANG_C_API int motionlang_write_motion(const motionlang_motion* motion, const char* file);
/* Several motions into one .glb (on one skeleton) or .html file. */
MOTIONLANG_C_API int motionlang_write_motions(const motionlang_motion* const* motions, int64_t count, const char* file);
/* The contents of such a file in memory. `kind` is its extension, ".glb". */
MOTIONLANG_C_API int motionlang_motion_bytes(const motionlang_motion* motion, const char* kind,
                                             motionlang_bytes** bytes);
MOTIONLANG_C_API const void* motionlang_bytes_data(const motionlang_bytes* bytes);
MOTIONLANG_C_API int64_t motionlang_bytes_size(const motionlang_bytes* bytes);
MOTIONLANG_C_API void motionlang_free_bytes(motionlang_bytes* bytes); /* of NULL: nothing */

/* "walk": the name that the file, its animation or its root has; valid as long as the motion. "" of NULL. */
MOTIONLANG_C_API const char* motionlang_motion_name(const motionlang_motion* motion);
/* The motion on the skeleton of another one, which was read from the file of a character: Mixamo, Unreal, VRM, CMU, ...
 * (joints by name). */
MOTIONLANG_C_API int motionlang_retarget(const motionlang_motion* motion, const motionlang_motion* character,
                                         motionlang_motion** result);
MOTIONLANG_C_API void motionlang_free_motion(motionlang_motion* motion); /* of NULL: nothing */

MOTIONLANG_C_API int64_t motionlang_frames(const motionlang_motion* motion);
MOTIONLANG_C_API int32_t motionlang_joints(const motionlang_motion* motion);
MOTIONLANG_C_API double motionlang_fps(const motionlang_motion* motion);
/* Name of joint 0 ... joints-1 (NULL: no such joint), and its parent, which comes before it (-1: the root has none). */
MOTIONLANG_C_API const char* motionlang_joint_name(const motionlang_motion* motion, int32_t joint);
MOTIONLANG_C_API int32_t motionlang_joint_parent(const motionlang_motion* motion, int32_t joint);

/* Copies of numbers, into `room` floats; 205 if that is not exactly how many there are.
 *   offsets     (joints, 3): from the parent, in the rest pose
 *   root        (frames, 3): where the root is
 *   rotations   (frames, joints, 4): against the parent
 *   positions   (frames, joints, 3): in the world */
MOTIONLANG_C_API int motionlang_offsets(const motionlang_motion* motion, float* xyz, int64_t room);
MOTIONLANG_C_API int motionlang_root(const motionlang_motion* motion, float* xyz, int64_t room);
MOTIONLANG_C_API int motionlang_rotations(const motionlang_motion* motion, float* wxyz, int64_t room);
MOTIONLANG_C_API int motionlang_positions(const motionlang_motion* motion, float* xyz, int64_t room);

/* ---- Search: motions by words, or by another motion. ---- */

typedef struct motionlang_index motionlang_index; /* vectors of motions, with the model (TMR) that made them */
typedef struct motionlang_hits motionlang_hits;   /* the answer to a search, best first */

typedef struct motionlang_index_options {
  const char* model;            /* folder of TMR, examples/models/tmr_free for instance; NULL: that of the index */
  const char* text_encoder;     /* language model that it reads, if it has no word pieces of its own; may be NULL */
  const char* license;          /* of all motions; NULL: the first line of the LICENSE file beside or above them */
  int32_t moments;              /* of a new index: 1: moments of 1, 2 and 3 seconds as well, 0: only whole clips */
  int32_t again;                /* 1: read all files, changed or not */
  motionlang_progress progress; /* called after some files each; may be NULL */
  void* user;                   /* for progress */
} motionlang_index_options;
/* Moments, everything else 0 or NULL. */
MOTIONLANG_C_API motionlang_index_options motionlang_default_index_options(void);

/* What an update of an index did: clips, files. */
typedef struct motionlang_index_report {
  int64_t clips;                       /* in the index now */
  int64_t added, removed;              /* clips */
  int64_t renamed, unchanged, skipped; /* files; clips that could not be read or encoded */
} motionlang_index_report;

/* Makes the index of a folder of motions, or updates it: files that have not changed are not read again. If `progress`
 * stops the work, what was done until then is in the file. `report` may be NULL. */
MOTIONLANG_C_API int motionlang_update_index(const char* index_file, const char* folder,
                                             const motionlang_index_options* options, motionlang_index_report* report);
/* Opens an index with its model. model, text_encoder: if they are not where they were, otherwise NULL. */
MOTIONLANG_C_API int motionlang_open_index(const char* index_file, const char* model, const char* text_encoder,
                                           motionlang_index** index);
MOTIONLANG_C_API int64_t motionlang_index_clips(const motionlang_index* index);
MOTIONLANG_C_API void motionlang_free_index(motionlang_index* index); /* of NULL: nothing */

#define MOTIONLANG_SEARCH_CLIPS 0    /* whole clips */
#define MOTIONLANG_SEARCH_MOMENTS 1  /* windows of clips */
#define MOTIONLANG_SEARCH_CAPTIONS 2 /* the captions of clips, not their motion */

typedef struct motionlang_search_options {
  int64_t top;         /* how many */
  int32_t what;        /* MOTIONLANG_SEARCH_... */
  double most_overlap; /* of two moments of one clip, intersection over union: more is one hit */
} motionlang_search_options;
/* Ten clips; overlap 0.3. */
MOTIONLANG_C_API motionlang_search_options motionlang_default_search_options(void);

/* The default options are taken where options is NULL. 102 for moments of an index without any. */
MOTIONLANG_C_API int motionlang_search_text(const motionlang_index* index, const char* text,
                                            const motionlang_search_options* options, motionlang_hits** hits);
MOTIONLANG_C_API int motionlang_search_motion(const motionlang_index* index, const motionlang_motion* motion,
                                              const motionlang_search_options* options, motionlang_hits** hits);

typedef struct motionlang_hit {
  const char* path;    /* of the file */
  const char* name;    /* of the motion in the file, where there are several; "" otherwise */
  const char* caption; /* the first one of the clip; "" if it has none */
  const char* license; /* "" if none is known */
  double start, end;   /* seconds in the file */
  double score;        /* 0 to 1 */
} motionlang_hit;
MOTIONLANG_C_API int64_t motionlang_hits_count(const motionlang_hits* hits);
/* The texts belong to the hits. Error 203 if there is no such hit. */
MOTIONLANG_C_API int motionlang_hits_at(const motionlang_hits* hits, int64_t i, motionlang_hit* hit);
MOTIONLANG_C_API void motionlang_free_hits(motionlang_hits* hits); /* of NULL: nothing */

#ifdef __cplusplus
}
#endif

#endif
