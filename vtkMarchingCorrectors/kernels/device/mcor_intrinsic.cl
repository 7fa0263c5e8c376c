/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Extensions of compilers for CPUs, and the same functions in plain OpenCL C for all other
 * compilers. Only this file depends on the compiler. */

#ifndef __has_builtin
#define __has_builtin(name) 0
#endif

/* 1 if the compiler makes a CPU's instructions itself. A compiler that makes SPIR-V first may know
 * the built-in functions below, too, but SPIR-V cannot express them. */
#if (defined(__x86_64__) || defined(__i386__) || defined(__aarch64__) || defined(__arm__) ||       \
  defined(__powerpc64__) || defined(__riscv)) &&                                                   \
  !defined(__SPIRV__)
#define MCOR_FOR_CPU 1
#else
#define MCOR_FOR_CPU 0
#endif

/* MCOR_LOAD and MCOR_LOAD_FIX read MCOR_LANES elements from p[i] on; MCOR_STORE writes as many. On
 * CPUs, MCOR_LOAD_FIX avoids vloadn, because compilers may split vloadn into several accesses. */
#if MCOR_LANES == 1
#define MCOR_LOAD(i, p) ((p)[i])
#define MCOR_STORE(v, i, p) ((p)[i] = (v))
#define MCOR_LOAD_FIX(i, p) ((p)[i])
#else
#define MCOR_LOAD(i, p) MCOR_CAT(vload, MCOR_LANES)(0, (p) + (i))
#define MCOR_STORE(v, i, p) MCOR_CAT(vstore, MCOR_LANES)(v, 0, (p) + (i))
#if MCOR_FOR_CPU
typedef fixv __attribute__((aligned(4))) mcor_loose_fixv;
#define MCOR_LOAD_FIX(i, p) (*(__global const mcor_loose_fixv*)((p) + (i)))
#else
#define MCOR_LOAD_FIX(i, p) MCOR_CAT(vload, MCOR_LANES)(0, (p) + (i))
#endif
#endif

/* MCOR_MASK makes a mask of the lanes to keep. For these lanes, MCOR_PACK_REAL writes the lanes'
 * values, and MCOR_PACK_INDEX the numbers first + lane, next to each other, to an array with room
 * for MCOR_LANES elements. */
#if MCOR_LANES == 16 && !MCOR_DOUBLE && MCOR_FOR_CPU && defined(__AVX512F__) &&                    \
  __has_builtin(__builtin_ia32_compresssf512_mask) &&                                              \
  __has_builtin(__builtin_ia32_compresssi512_mask) && __has_builtin(__builtin_ia32_cmpd512_mask)
/* The vector unit has an instruction that writes the kept lanes next to each other. The instruction
 * saves a third of the time of a gather. */
typedef ushort mcor_mask;
typedef realv __attribute__((aligned(4))) mcor_loose_realv;
#define MCOR_MASK(keep, lanes)                                                                     \
  ((mcor_mask)__builtin_ia32_cmpd512_mask(                                                         \
    (keep), (int16)0, 4, (mcor_mask)((1u << (lanes)) - 1))) /* 4: not equal */
#define MCOR_PACK_REAL(mask, v, to)                                                                \
  (*(mcor_loose_realv*)(to) = __builtin_ia32_compresssf512_mask((v), (float16)0, (mask)))
#define MCOR_PACK_INDEX(mask, first, to)                                                           \
  (*(mcor_loose_fixv*)(to) =                                                                       \
      __builtin_ia32_compresssi512_mask((first) + mcor_lane_index(), (int16)0, (mask)))
#define MCOR_MASK_COUNT(mask) ((int)popcount(mask))
#define MCOR_PARTS 4

/* Writes a0 b0 c0 d0 a1 b1 ... */
void mcor_interleave4(realv a, realv b, realv c, realv d, real* to)
{
#define MCOR_LOW_HALVES 0, 16, 1, 17, 2, 18, 3, 19, 4, 20, 5, 21, 6, 22, 7, 23
#define MCOR_HIGH_HALVES 8, 24, 9, 25, 10, 26, 11, 27, 12, 28, 13, 29, 14, 30, 15, 31
#define MCOR_LOW_PAIRS 0, 1, 16, 17, 2, 3, 18, 19, 4, 5, 20, 21, 6, 7, 22, 23
#define MCOR_HIGH_PAIRS 8, 9, 24, 25, 10, 11, 26, 27, 12, 13, 28, 29, 14, 15, 30, 31
  const realv ab = __builtin_shufflevector(a, b, MCOR_LOW_HALVES);
  const realv cd = __builtin_shufflevector(c, d, MCOR_LOW_HALVES);
  const realv ef = __builtin_shufflevector(a, b, MCOR_HIGH_HALVES);
  const realv gh = __builtin_shufflevector(c, d, MCOR_HIGH_HALVES);
  vstore16(__builtin_shufflevector(ab, cd, MCOR_LOW_PAIRS), 0, to);
  vstore16(__builtin_shufflevector(ab, cd, MCOR_HIGH_PAIRS), 1, to);
  vstore16(__builtin_shufflevector(ef, gh, MCOR_LOW_PAIRS), 2, to);
  vstore16(__builtin_shufflevector(ef, gh, MCOR_HIGH_PAIRS), 3, to);
}
#elif MCOR_LANES == 8 && !MCOR_DOUBLE && MCOR_FOR_CPU && defined(__AVX2__) && defined(__BMI2__) && \
  __has_builtin(__builtin_ia32_movmskps256) && __has_builtin(__builtin_ia32_permvarsf256) &&       \
  __has_builtin(__builtin_ia32_pdep_di) && __has_builtin(__builtin_ia32_pext_di)
/* The vector unit has an instruction that permutes lanes. kept: the numbers of the `count` lanes
 * that are kept, then zeros. */
typedef struct
{
  int8 kept;
  int count;
} mcor_mask;
typedef realv __attribute__((aligned(4))) mcor_loose_realv;
typedef fixv __attribute__((aligned(4))) mcor_loose_lanes;

mcor_mask mcor_mask_of(fixv keep, int lanes)
{
  const uint bits = (uint)__builtin_ia32_movmskps256(as_float8(keep != 0)) & ((1u << lanes) - 1);
  const ulong bytes = __builtin_ia32_pdep_di(bits, 0x0101010101010101UL) * 0xff;
  mcor_mask mask;
  mask.kept = convert_int8(as_uchar8(__builtin_ia32_pext_di(0x0706050403020100UL, bytes)));
  mask.count = (int)popcount(bits);
  return mask;
}
#define MCOR_MASK mcor_mask_of
#define MCOR_PACK_REAL(mask, v, to)                                                                \
  (*(mcor_loose_realv*)(to) = __builtin_ia32_permvarsf256((v), (mask).kept))
#define MCOR_PACK_INDEX(mask, first, to) (*(mcor_loose_lanes*)(to) = (first) + (mask).kept)
#define MCOR_MASK_COUNT(mask) ((mask).count)
#elif MCOR_LANES > 1
typedef struct
{
  int lanes;
  fix keep[MCOR_LANES];
} mcor_mask;

mcor_mask mcor_mask_of(fixv keep, int lanes)
{
  mcor_mask mask;
  mask.lanes = lanes;
  MCOR_STORE(keep & 1, 0, mask.keep);
  return mask;
}

void mcor_pack_real(const mcor_mask* mask, realv v, real* to)
{
  for (int lane = 0; lane < mask->lanes; ++lane)
  {
    *to = MCOR_GET(v, lane);
    to += mask->keep[lane];
  }
}

void mcor_pack_index(const mcor_mask* mask, int first, int* to)
{
  for (int lane = 0; lane < mask->lanes; ++lane)
  {
    *to = first + lane;
    to += mask->keep[lane];
  }
}

int mcor_mask_count(const mcor_mask* mask)
{
  int count = 0;
  for (int lane = 0; lane < mask->lanes; ++lane)
  {
    count += (int)mask->keep[lane];
  }
  return count;
}
#define MCOR_MASK mcor_mask_of
#define MCOR_PACK_REAL(mask, v, to) mcor_pack_real(&(mask), v, to)
#define MCOR_PACK_INDEX(mask, first, to) mcor_pack_index(&(mask), first, to)
#define MCOR_MASK_COUNT(mask) mcor_mask_count(&(mask))
#endif

#ifndef MCOR_PARTS
#define MCOR_PARTS 1
#endif
