// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "ScratchFile.h"

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <stdexcept>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#ifdef __linux__
#include <sys/mman.h>
#endif

namespace
{

[[noreturn]] void Fail()
{
  throw std::runtime_error(std::string("a temporary file failed: ") + std::strerror(errno));
}

}

//------------------------------------------------------------------------------
ScratchFile::ScratchFile()
{
#ifdef MFD_CLOEXEC
  this->Descriptor = memfd_create("marching-correctors", MFD_CLOEXEC);
#endif
  if (this->Descriptor < 0)
  {
    std::FILE* file = std::tmpfile();
    this->Descriptor = file ? fcntl(fileno(file), F_DUPFD_CLOEXEC, 0) : -1;
    if (file)
    {
      std::fclose(file);
    }
  }
  if (this->Descriptor < 0)
  {
    Fail();
  }
}

//------------------------------------------------------------------------------
ScratchFile::~ScratchFile()
{
  close(this->Descriptor);
}

//------------------------------------------------------------------------------
std::string ScratchFile::GetName() const
{
  return "/dev/fd/" + std::to_string(this->Descriptor);
}

//------------------------------------------------------------------------------
void ScratchFile::Append(const std::string& bytes)
{
  lseek(this->Descriptor, 0, SEEK_END);
  for (std::size_t done = 0; done < bytes.size();)
  {
    const ssize_t written = write(this->Descriptor, bytes.data() + done, bytes.size() - done);
    if (written < 0 && errno != EINTR)
    {
      Fail();
    }
    done += written > 0 ? static_cast<std::size_t>(written) : 0;
  }
}

//------------------------------------------------------------------------------
std::string ScratchFile::Read() const
{
  struct stat status = {};
  if (fstat(this->Descriptor, &status) != 0)
  {
    Fail();
  }
  std::string bytes(static_cast<std::size_t>(status.st_size), '\0');
  for (std::size_t done = 0; done < bytes.size();)
  {
    const ssize_t got =
      pread(this->Descriptor, &bytes[done], bytes.size() - done, static_cast<off_t>(done));
    if (got == 0 || (got < 0 && errno != EINTR))
    {
      Fail();
    }
    done += got > 0 ? static_cast<std::size_t>(got) : 0;
  }
  return bytes;
}
