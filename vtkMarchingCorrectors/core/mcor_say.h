/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef mcor_say_h
#define mcor_say_h

/* Writes sentences of mcor_says.def. VTK's filters and the program use vtkSPHSay.h for this. */

#include "mcor.h"

#ifdef __cplusplus
extern "C"
{
#endif

/* A code and its text, as two arguments. Texts are arrays, not pointers, so that compilers check the
 * formats in them. */
#define MCOR_SAY(code) MCOR_SAYS_##code, mcor_text_of_##code
#define SAYS(code, text) static const char mcor_text_of_##code[] = text;
#include "mcor_says.def"

  /* Writes a sentence; use as mcor_say(MCOR_SAY(CODE), ...). */
  mcor_message mcor_say(mcor_says code, const char* format, ...)
#ifdef __GNUC__
    __attribute__((format(printf, 2, 3)))
#endif
    ;

#ifdef __cplusplus
}
#endif

#endif
