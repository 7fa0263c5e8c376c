// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "OutputFile.h"

#include "Supervisor.h"

#include <cctype>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <set>
#include <stdexcept>
#include <tuple>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

namespace
{

namespace fs = std::filesystem;

[[noreturn]] void Fail(const std::string& file, const std::string& why)
{
  throw std::runtime_error(file + " could not be written: " + why);
}

[[noreturn]] void FailWithError(const std::string& file)
{
  Fail(file, std::strerror(errno));
}

/// Where an output goes.
struct Target
{
  std::string Name;    ///< as given
  std::string Path;    ///< symbolic links followed
  int Descriptor = -1; ///< the open one that this is a name of (/dev/stdout, /dev/fd/3)
  bool Exists = false;
  struct stat Status = {}; ///< where it exists

  /// Whether a new file takes its place, or it is written to straight.
  bool IsReplaced() const
  {
    return this->Descriptor < 0 && (!this->Exists || S_ISREG(this->Status.st_mode));
  }
};

std::string FolderOf(const std::string& path)
{
  const std::string folder = fs::path(path).parent_path().string();
  return folder.empty() ? "." : folder;
}

/// The number of an open descriptor that has a name in the file system; -1 if this is none. To open
/// such a name is not the same: it would give a file position of its own.
int DescriptorOf(const std::string& path)
{
  const std::string number = fs::path(path).filename().string();
  if (number.empty() || number.size() > 6 ||
    number.find_first_not_of("0123456789") != std::string::npos)
  {
    return -1;
  }
  std::error_code ignored;
  const std::string folder = FolderOf(path);
  return fs::equivalent(folder, "/dev/fd", ignored) ||
      fs::equivalent(folder, "/proc/self/fd", ignored)
    ? std::atoi(number.c_str())
    : -1;
}

/// Follows symbolic links, also to a file that does not exist yet.
void FollowLinks(Target& target)
{
  const int mostLinks = 40; // as the kernel of Linux
  std::error_code error;
  for (int i = 0; i <= mostLinks; ++i)
  {
    target.Descriptor = DescriptorOf(target.Path);
    if (target.Descriptor >= 0 || !fs::is_symlink(target.Path, error))
    {
      return;
    }
    // The operator leaves an absolute path as it is.
    target.Path = (FolderOf(target.Path) / fs::read_symlink(target.Path, error)).string();
  }
  errno = ELOOP;
  FailWithError(target.Name);
}

/// The rules of the system for whom links serve, and for files that may not be written, hold for
/// what is replaced, too: it is asked, by the name as given.
void CheckAccess(const Target& target)
{
  if (!target.IsReplaced())
  {
    if (target.Descriptor < 0 && access(target.Name.c_str(), W_OK) != 0)
    {
      FailWithError(target.Name);
    }
    return;
  }
  if (target.Exists)
  {
    const int descriptor = open(target.Name.c_str(), O_WRONLY | O_CLOEXEC | O_NOCTTY);
    if (descriptor < 0)
    {
      FailWithError(target.Name);
    }
    close(descriptor);
  }
  const std::string folder = FolderOf(target.Path);
  if (access(folder.c_str(), W_OK | X_OK) != 0)
  {
    Fail(target.Name,
      "no file can be made in the folder " + folder + " (" + std::strerror(errno) + ")");
  }
}

Target Find(const std::string& name)
{
  Target target;
  target.Name = name;
  target.Path = name;
  FollowLinks(target);
  target.Exists = (target.Descriptor >= 0 ? fstat(target.Descriptor, &target.Status)
                                          : stat(name.c_str(), &target.Status)) == 0;
  if (!target.Exists && (errno != ENOENT || target.Descriptor >= 0))
  {
    FailWithError(name);
  }
  if (target.Exists && S_ISDIR(target.Status.st_mode))
  {
    Fail(name, "it is a directory");
  }
  CheckAccess(target);
  return target;
}

/// The same for all names of one file; of one that does not exist yet, its place. Devices such as
/// /dev/null or a terminal are nobody's own.
using Identity = std::tuple<dev_t, ino_t, std::string>;

bool Identify(const Target& target, Identity& identity)
{
  struct stat status = target.Status;
  const std::string folder = FolderOf(target.Path);
  if (!target.Exists && stat(folder.c_str(), &status) != 0)
  {
    return false;
  }
  const std::string name = target.Exists ? "" : fs::path(target.Path).filename().string();
  identity = Identity(status.st_dev, status.st_ino, name);
  return !target.Exists || !S_ISCHR(status.st_mode);
}

bool IsSame(const Target& a, const Target& b)
{
  Identity first, second;
  return Identify(a, first) && Identify(b, second) && first == second;
}

/// What exists under this name, or is open as this descriptor, without any check.
Target Other(const std::string& name, int descriptor)
{
  Target target;
  target.Name = name;
  target.Path = name;
  target.Exists =
    (descriptor < 0 ? stat(name.c_str(), &target.Status) : fstat(descriptor, &target.Status)) == 0;
  return target;
}

void WriteAll(int descriptor, const std::string& bytes, const std::string& file)
{
  const char* next = bytes.data();
  std::size_t left = bytes.size();
  while (left > 0)
  {
    const ssize_t written = write(descriptor, next, left);
    if (written < 0 && errno != EINTR)
    {
      FailWithError(file);
    }
    if (written > 0)
    {
      next += written;
      left -= static_cast<std::size_t>(written);
    }
  }
}

void WriteStraight(const Target& target, const std::string& bytes)
{
  const bool isOpen = target.Descriptor >= 0;
  const int descriptor =
    isOpen ? target.Descriptor : open(target.Name.c_str(), O_WRONLY | O_CLOEXEC | O_NOCTTY);
  if (descriptor < 0)
  {
    FailWithError(target.Name);
  }
  try
  {
    WriteAll(descriptor, bytes, target.Name);
  }
  catch (const std::runtime_error&)
  {
    if (!isOpen)
    {
      close(descriptor);
    }
    throw;
  }
  if (!isOpen && close(descriptor) != 0)
  {
    FailWithError(target.Name);
  }
}

/// A new file beside the target, with a name that nobody could know before; it goes away with the
/// object, or with the process, unless it takes the target's place.
class Replacement
{
public:
  explicit Replacement(const Target& target)
    : Place(target)
  {
    const std::size_t longest = 200; // of 255 bytes
    const std::string name = fs::path(target.Path).filename().string().substr(0, longest);
    this->Path = FolderOf(target.Path) + "/." + name + ".XXXXXX";
    const SignalPause pause;
    this->Descriptor = mkstemp(&this->Path[0]);
    if (this->Descriptor < 0)
    {
      FailWithError(target.Name);
    }
    SetTemporaryFile(this->Path);
  }

  ~Replacement()
  {
    if (this->Descriptor >= 0)
    {
      close(this->Descriptor);
    }
    if (!this->Done)
    {
      std::remove(this->Path.c_str());
    }
    SetTemporaryFile("");
  }

  Replacement(const Replacement&) = delete;
  void operator=(const Replacement&) = delete;

  void Write(const std::string& bytes) { WriteAll(this->Descriptor, bytes, this->Place.Name); }

  void TakePlace()
  {
    this->SetAttributes();
    // Some file systems have no fsync, and some tell only then that the disk is full.
    const bool synced = fsync(this->Descriptor) == 0 || errno == EINVAL || errno == ENOTSUP;
    const int descriptor = this->Descriptor;
    this->Descriptor = -1;
    if (!synced)
    {
      const int error = errno;
      close(descriptor);
      errno = error;
      FailWithError(this->Place.Name);
    }
    const SignalPause pause;
    if (close(descriptor) != 0 || std::rename(this->Path.c_str(), this->Place.Path.c_str()) != 0)
    {
      FailWithError(this->Place.Name);
    }
    this->Done = true;
  }

private:
  /// As those of the file that is replaced; for a new one, as the umask says.
  void SetAttributes()
  {
    const struct stat& old = this->Place.Status;
    const mode_t mask = umask(0);
    umask(mask);
    mode_t mode = this->Place.Exists ? old.st_mode & 07777 : 0666 & ~mask;
    if (this->Place.Exists)
    {
      // Another owner or group must not gain what the old one was allowed.
      const bool sameGroup = fchown(this->Descriptor, static_cast<uid_t>(-1), old.st_gid) == 0;
      const bool sameOwner = fchown(this->Descriptor, old.st_uid, static_cast<gid_t>(-1)) == 0;
      mode &= ~static_cast<mode_t>((sameGroup ? 0 : 02070) | (sameOwner ? 0 : 04000));
    }
    if (fchmod(this->Descriptor, mode) != 0)
    {
      FailWithError(this->Place.Name);
    }
  }

  const Target Place;
  std::string Path;
  int Descriptor = -1;
  bool Done = false;
};

}

//------------------------------------------------------------------------------
void CheckOutputs(const std::vector<std::string>& inputs, const std::vector<std::string>& outputs)
{
  std::set<Identity> sources, found;
  Identity identity;
  for (const std::string& input : inputs)
  {
    const Target source = Other(input, -1);
    if (source.Exists && Identify(source, identity))
    {
      sources.insert(identity);
    }
  }
  for (const std::string& output : outputs)
  {
    const Target target = Find(output);
    if (Identify(target, identity))
    {
      if (sources.count(identity))
      {
        throw std::invalid_argument(output + " would overwrite the input");
      }
      if (!found.insert(identity).second)
      {
        throw std::invalid_argument(output + " would be written twice");
      }
    }
    for (const int stream : { STDOUT_FILENO, STDERR_FILENO })
    {
      if (target.Exists && target.IsReplaced() && IsSame(target, Other("", stream)))
      {
        throw std::invalid_argument(output + " would be written twice: what is printed goes there");
      }
    }
  }
}

//------------------------------------------------------------------------------
void WriteOutput(const std::string& file, const std::string& bytes)
{
  const Target target = Find(file);
  if (!target.IsReplaced())
  {
    WriteStraight(target, bytes);
    return;
  }
  Replacement replacement(target);
  replacement.Write(bytes);
  replacement.TakePlace();
}
