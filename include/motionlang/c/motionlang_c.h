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

/* "0.1.0" */
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
} motionlang_options;
/* What the program `motionlang generate` does: seed 0, all that the model wants, cut, smooth, feet fixed. */
MOTIONLANG_C_API motionlang_options motionlang_default_options(void);

/* The motion of a timeline, one text on a line: "walk forward # 0.0 # 6.0 # legs" (text # start # end in seconds # body
 * parts: left arm, right arm, legs, spine, head; none: the whole body). Errors 501 ... 510 have line and column. The
 * default options are taken where options is NULL. */
MOTIONLANG_C_API int motionlang_generate(const motionlang_model* model, const char* timeline,
                                         const motionlang_options* options, motionlang_motion** motion);

/* From a .bvh, .glb or .gltf file; into a .bvh, .glb or .html file (a page to look at). */
MOTIONLANG_C_API int motionlang_read_motion(const char* file, motionlang_motion** motion);
MOTIONLANG_C_API int motionlang_write_motion(const motionlang_motion* motion, const char* file);
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

#ifdef __cplusplus
}
#endif

#endif
