// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
/** Private to the module and the program: sentences of mcor_says.def. */
#ifndef vtkSPHSay_h
#define vtkSPHSay_h

#include "mcor_say.h"
#include "vtkMarchingCorrectorsModule.h" // For export macro

#include <string>

/**
 * Returns a sentence with its slots filled, see vtkSPHAlgorithm::SetWord(). Call it as
 * vtkSPHSay(MCOR_SAY(CODE), ...).
 */
VTKMARCHINGCORRECTORS_EXPORT std::string vtkSPHSay(mcor_says code, const char* format, ...)
#ifdef __GNUC__
  __attribute__((format(printf, 2, 3)))
#endif
  ;

#endif
