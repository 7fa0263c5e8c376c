// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "OutputFile.h"

#include "Failures.h"
#include "ParticleFile.h"
#include "Text.h"

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <set>
#include <tuple>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

/// An output under way: a new file that will replace the target, or bytes for a target that is kept.
struct OutputTarget
{
  std::string Name;    ///< as given
  std::string Path;    ///< the path behind symbolic links
  int Descriptor = -1; ///< the open descriptor, if Path names one (/dev/stdout, /dev/fd/3)
  bool Exists = false;
  struct stat Status = {}; ///< identity of the target, if it exists
  std::string Bytes;       ///< what is still to be written to a target that is kept
  std::string File;        ///< the new file's name, while there is one

  /// Whether a new file replaces the target; otherwise bytes are written straight to the target.
  bool IsReplaced() const
  {
    return this->Descriptor < 0 && (!this->Exists || S_ISREG(this->Status.st_mode));
  }
};

namespace
{

namespace fs = std::filesystem;
using Target = OutputTarget;

/// Unless `isGood`, fails with `why` or, if it is empty, with the system's reason.
void Check(bool isGood, const std::string& file, const std::string& why = "")
{
  RequireToWrite(isGood, file, why.empty() ? std::strerror(errno) : why);
}

std::string FolderOf(const std::string& path)
{
  const std::string folder = fs::path(path).parent_path().string();
  return folder.empty() ? "." : folder;
}

/// Follows symbolic links, also to a file that does not exist yet. Asks the system, by the given
/// name, whether the file may be written: the system's rules for links and for protected files then
/// hold for replacing, too. Refuses a file that the run reads.
Target Find(const std::string& name)
{
  Target target;
  target.Name = target.Path = name;
  const int mostLinks = 40; // the limit of Linux' kernel
  std::error_code error;
  // An open descriptor must not be opened again, because the file would then have a second position.
  const auto isDescriptor = [&target, &error]
  { return fs::equivalent(FolderOf(target.Path), "/proc/self/fd", error); };
  for (int i = 0; !isDescriptor() && fs::is_symlink(target.Path, error); ++i)
  {
    Check(i < mostLinks, name, std::strerror(ELOOP));
    // operator/ leaves an absolute path as it is.
    target.Path = (FolderOf(target.Path) / fs::read_symlink(target.Path, error)).string();
  }
  target.Descriptor = isDescriptor() ? std::atoi(fs::path(target.Path).filename().c_str()) : -1;
  target.Exists = stat(name.c_str(), &target.Status) == 0;
  Check(target.Exists || (errno == ENOENT && target.Descriptor < 0), name);
  Check(!target.Exists || !S_ISDIR(target.Status.st_mode), name, "it is a directory");
  Need(!target.Exists || !IsSource(target.Status), name + " would overwrite the input");
  if (!target.IsReplaced())
  {
    Check(target.Descriptor >= 0 || access(name.c_str(), W_OK) == 0, name);
    return target;
  }
  if (target.Exists)
  {
    const int descriptor = open(name.c_str(), O_WRONLY | O_CLOEXEC | O_NOCTTY);
    Check(descriptor >= 0, name);
    close(descriptor);
  }
  const std::string folder = FolderOf(target.Path);
  const bool isOpen = access(folder.c_str(), W_OK | X_OK) == 0;
  Check(isOpen, name,
    "no file can be created in the folder " + folder + " (" + std::strerror(errno) + ")");
  return target;
}

/// Returns an identity that is the same for all names of one file. A file that does not exist yet
/// is identified by its folder and its name.
using Identity = std::tuple<dev_t, ino_t, std::string>;

Identity Identify(const Target& target)
{
  struct stat status = target.Status;
  const bool isFolder = !target.Exists && stat(FolderOf(target.Path).c_str(), &status) == 0;
  return { status.st_dev, status.st_ino,
    isFolder ? fs::path(target.Path).filename().string() : "" };
}

/// Sets mode, owner and group to those of the replaced file; for a new file, the umask decides.
bool SetAttributes(int descriptor, const Target& target)
{
  const struct stat& old = target.Status;
  const mode_t mask = umask(0);
  umask(mask);
  mode_t mode = target.Exists ? old.st_mode & 07777 : 0666 & ~mask;
  if (target.Exists)
  {
    // If the group cannot stay, the new one gets no permissions. A set-ID bit stays only with its owner or group.
    const bool sameGroup = fchown(descriptor, static_cast<uid_t>(-1), old.st_gid) == 0;
    const bool sameOwner = fchown(descriptor, old.st_uid, static_cast<gid_t>(-1)) == 0;
    mode &= ~static_cast<mode_t>((sameGroup ? 0 : 02070) | (sameOwner ? 0 : 04000));
  }
  return fchmod(descriptor, mode) == 0;
}

/// Writes all bytes to the target, or to the file that will replace it, and closes the file. Returns
/// false, and sets errno, if the bytes were not stored.
bool Store(int descriptor, const std::string& bytes, const Target& target)
{
  bool isGood = descriptor >= 0;
  for (std::size_t done = 0; isGood && done < bytes.size();)
  {
    const ssize_t written = write(descriptor, bytes.data() + done, bytes.size() - done);
    isGood = written >= 0 || errno == EINTR;
    done += written > 0 ? static_cast<std::size_t>(written) : 0;
  }
  // Some file systems have no fsync, and some report a full disk only here.
  isGood = isGood &&
    (!target.IsReplaced() ||
      (SetAttributes(descriptor, target) &&
        (fsync(descriptor) == 0 || errno == EINVAL || errno == ENOTSUP)));
  const int problem = errno;
  const bool isClosed = descriptor < 0 || close(descriptor) == 0;
  errno = isGood ? errno : problem;
  return isGood && isClosed;
}
}

void CheckOutputs(const std::vector<std::string>& outputs)
{
  std::set<Identity> streams, found;
  for (const int stream : { STDOUT_FILENO, STDERR_FILENO })
  {
    Target target;
    target.Exists = fstat(stream, &target.Status) == 0;
    streams.insert(Identify(target));
  }
  for (const std::string& output : outputs)
  {
    if (output.empty())
    {
      continue;
    }
    const Target target = Find(output);
    if (!target.Exists || !S_ISCHR(target.Status.st_mode)) // not a terminal, nor /dev/null
    {
      const Identity identity = Identify(target);
      Need(found.insert(identity).second, output + " would be written twice");
      Need(!target.IsReplaced() || !streams.count(identity),
        output + " would be written twice: standard output goes there, too");
    }
  }
}

OutputFiles::OutputFiles() = default;

OutputFiles::~OutputFiles()
{
  for (const Target& target : this->Files)
  {
    if (!target.File.empty())
    {
      EndTemporary(target.File);
    }
  }
}

void OutputFiles::Write(const std::string& file, const std::string& bytes)
{
  Target& target = this->Files.emplace_back(Find(file));
  if (!target.IsReplaced())
  {
    target.Bytes = bytes;
    return;
  }
  const std::size_t longest = 200; // a name has at most 255 bytes
  const std::string name = fs::path(target.Path).filename().string();
  target.File = FolderOf(target.Path) + "/." + name.substr(0, longest) + ".";
  const int descriptor = MakeTemporary(target.File);
  Check(Store(descriptor, bytes, target), file);
}

void OutputFiles::Commit()
{
  for (Target& target : this->Files)
  {
    if (target.IsReplaced())
    {
      Check(EndTemporary(target.File, target.Path), target.Name);
      target.File.clear();
      continue;
    }
    const int descriptor = target.Descriptor >= 0
      ? fcntl(target.Descriptor, F_DUPFD_CLOEXEC, 0)
      : open(target.Name.c_str(), O_WRONLY | O_CLOEXEC | O_NOCTTY);
    Check(Store(descriptor, target.Bytes, target), target.Name);
  }
  this->Files.clear();
}

void WriteOutput(const std::string& file, const std::string& bytes)
{
  OutputFiles one;
  one.Write(file, bytes);
  one.Commit();
}

void GrowingFile::Write(const std::string& text, bool isLast)
{
  std::error_code error;
  const fs::file_status status = fs::status(this->Name, error);
  const auto begin = Clock::now();
  const bool mayGrow = !fs::exists(status) || fs::is_regular_file(status);
  if (this->Name.empty() || (!isLast && (!mayGrow || begin < this->Next)))
  {
    return;
  }
  WriteOutput(this->Name, text);
  this->Next = Clock::now() + 19 * (Clock::now() - begin);
}
