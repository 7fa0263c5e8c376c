// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#ifndef CollectionFile_h
#define CollectionFile_h

#include <string>
#include <vector>

class MessageCapture;

/// An entry of a .pvd file, ParaView's list of files and their times.
struct CollectionEntry
{
  double Time;
  std::string File; ///< as it can be opened: from the working directory, not from the .pvd file
  std::string Part; ///< what the list says it is a part of; empty: nothing
};

/// Whether the name ends as that of a .pvd file.
bool IsCollectionFile(const std::string& file);

/// Reads entries in the order of time. Entries of one time keep the order of the file; a file
/// counts once, and of one part the last entry. Throws std::runtime_error with one sentence;
/// `warnings` gets others.
std::vector<CollectionEntry> ReadCollection(
  const std::string& file, MessageCapture* messages, std::vector<std::string>& warnings);

/// The text of a .pvd file beside which the entries' files lie.
std::string CollectionText(const std::vector<CollectionEntry>& entries);

/// The files that are parts of one set of particles, from a .pvtp or .pvtu file.
std::vector<std::string> ReadPieces(const std::string& file, MessageCapture* messages);

#endif
