// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#ifndef Film_h
#define Film_h

class MessageCapture;
class Sharing;
struct Job;

/// Makes one surface for each time of a film, and the .pvd file that lists them. Names a step that
/// fails, does the others, and returns false then. Throws if there can be no film at all.
bool MakeFilm(const Job& job, MessageCapture* messages, Sharing& sharing);

#endif
