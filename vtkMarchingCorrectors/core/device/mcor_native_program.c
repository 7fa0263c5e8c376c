/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Finds which of the compiled programs suit this processor. The processor itself is asked, because
 * __builtin_cpu_supports works only with some of the compiler's libraries. */

#include "mcor_native.h"

#include <string.h>

#if defined(__x86_64__)
#include <cpuid.h>
#include <stdatomic.h>

#define MCOR_HAS(bits, wanted) (((bits) & (wanted)) == (wanted))

static mcor_instructions mcor_ask_processor(void)
{
  const unsigned fma_saved_avx = 1u << 12 | 1u << 27 | 1u << 28;
  const unsigned bmi_avx2_bmi2 = 1u << 3 | 1u << 5 | 1u << 8;
  const unsigned avx512_f_dq_cd_bw_vl = 1u << 16 | 1u << 17 | 1u << 28 | 1u << 30 | 1u << 31;
  unsigned a = 0, b = 0, c = 0, d = 0, state = 0, rest = 0;
  if (!__get_cpuid(1, &a, &b, &c, &d) || !MCOR_HAS(c, fma_saved_avx))
  {
    return MCOR_INSTRUCTIONS_BASE;
  }
  /* Reads which registers the system saves for each thread. */
  __asm__ volatile("xgetbv" : "=a"(state), "=d"(rest) : "c"(0));
  if (!__get_cpuid_count(7, 0, &a, &b, &c, &d) || !MCOR_HAS(state, 0x06u) ||
    !MCOR_HAS(b, bmi_avx2_bmi2))
  {
    return MCOR_INSTRUCTIONS_BASE;
  }
  return MCOR_HAS(state, 0xE6u) && MCOR_HAS(b, avx512_f_dq_cd_bw_vl) ? MCOR_INSTRUCTIONS_V4
                                                                     : MCOR_INSTRUCTIONS_V3;
}

/* Asks the processor once: each launch needs the answer, which takes long in virtual machines. */
static mcor_instructions mcor_own_instructions(void)
{
  static atomic_int known; /* the answer + 1; 0: not asked yet */
  int found = atomic_load_explicit(&known, memory_order_relaxed);
  if (found == 0)
  {
    found = (int)mcor_ask_processor() + 1;
    atomic_store_explicit(&known, found, memory_order_relaxed);
  }
  return (mcor_instructions)(found - 1);
}

#else

static mcor_instructions mcor_own_instructions(void)
{
  return MCOR_INSTRUCTIONS_BASE;
}

#endif

int mcor_best_instructions(void)
{
  const int own = (int)mcor_own_instructions();
  int best = -1;
  for (const mcor_native_program* p = mcor_native_programs; p->options; ++p)
  {
    const int instructions = (int)p->instructions;
    best = instructions <= own && instructions > best ? instructions : best;
  }
  return best;
}

const mcor_native_program* mcor_find_program(const char* options)
{
  const int best = mcor_best_instructions();
  const char* own = strstr(options, "-DMCOR_PROGRAM");
  const mcor_native_program* found = NULL;
  for (const mcor_native_program* p = mcor_native_programs; own && p->options; ++p)
  {
    if ((int)p->instructions <= best && strcmp(p->options, own) == 0 &&
      (!found || p->instructions > found->instructions))
    {
      found = p;
    }
  }
  return found;
}
