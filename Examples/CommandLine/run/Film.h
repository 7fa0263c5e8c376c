// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#ifndef Film_h
#define Film_h

class FilmRecord;
class MessageCapture;
struct CommandLineOptions;

/// One surface for each time of a film, and the .pvd file that lists them, from the step `first` on;
/// those before it are in the record. A step that fails is named and the others done: then this is
/// false. Throws where there can be no film at all.
bool MakeFilm(
  const CommandLineOptions& options, int first, FilmRecord& record, MessageCapture* messages);

#endif
