// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#ifndef Film_h
#define Film_h

class MessageCapture;
class Sharing;
struct Job;

/// One surface for each time of a film, and the .pvd file that lists them. A step that fails is named and
/// the others done: then this is false. Throws where there can be no film at all.
bool MakeFilm(const Job& job, MessageCapture* messages, Sharing& sharing);

#endif
