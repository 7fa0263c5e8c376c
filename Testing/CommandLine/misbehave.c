// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause

// A library for LD_PRELOAD that causes faults which tests cannot cause otherwise: system calls that
// fail or take long, a library that takes a signal for itself, and an XML library that fails.
//
//   MCOR_FAILING_CALL=fsync|close|rename  fails in MCOR_FAILING_FOLDER; fsync and close: on hidden files
//   MCOR_RENAME_SECONDS=N                 a rename to a path in MCOR_FAILING_FOLDER takes N seconds
//   MCOR_TAKES_HANGUPS=1                  SIGHUP does nothing any more, as with some MPIs' UCX
//   MCOR_READER=abort|recursion|fault     the XML library does this when VTK asks for a parser
//   MCOR_READER_CALL=N                    only the Nth and later parsers do so (default 1)
//   MCOR_DRIVER=abort                     a process that loads this OpenCL driver aborts
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <limits.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static int is_variable(const char* name, const char* value)
{
  const char* found = getenv(name);
  return found && strcmp(found, value) == 0;
}

static void do_nothing(int number)
{
  (void)number;
}

__attribute__((constructor)) static void begin(void)
{
  if (is_variable("MCOR_DRIVER", "abort"))
  {
    abort();
  }
  if (is_variable("MCOR_TAKES_HANGUPS", "1"))
  {
    signal(SIGHUP, do_nothing);
  }
}

static int fails(const char* call, int descriptor)
{
  char link[64];
  char path[PATH_MAX];
  const char* folder = getenv("MCOR_FAILING_FOLDER");
  if (!folder || !is_variable("MCOR_FAILING_CALL", call))
  {
    return 0;
  }
  snprintf(link, sizeof(link), "/proc/self/fd/%d", descriptor);
  const ssize_t length = readlink(link, path, sizeof(path) - 1);
  if (length < 0)
  {
    return 0;
  }
  path[length] = '\0';
  return strncmp(path, folder, strlen(folder)) == 0 && strstr(path, "/.") != NULL;
}

int fsync(int descriptor)
{
  int (*real)(int) = (int (*)(int))dlsym(RTLD_NEXT, "fsync");
  if (fails("fsync", descriptor))
  {
    errno = EIO;
    return -1;
  }
  return real(descriptor);
}

int close(int descriptor)
{
  int (*real)(int) = (int (*)(int))dlsym(RTLD_NEXT, "close");
  const int failed = fails("close", descriptor);
  const int result = real(descriptor);
  errno = failed ? EIO : errno;
  return failed ? -1 : result;
}

int rename(const char* from, const char* to)
{
  int (*real)(const char*, const char*) =
    (int (*)(const char*, const char*))dlsym(RTLD_NEXT, "rename");
  const char* folder = getenv("MCOR_FAILING_FOLDER");
  if (folder && strncmp(to, folder, strlen(folder)) == 0)
  {
    if (getenv("MCOR_RENAME_SECONDS"))
    {
      sleep((unsigned)atoi(getenv("MCOR_RENAME_SECONDS")));
    }
    if (is_variable("MCOR_FAILING_CALL", "rename"))
    {
      errno = EIO;
      return -1;
    }
  }
  return real(from, to);
}

static volatile int never = 0;

static int recurse(int depth)
{
  volatile char frame[4096];
  frame[0] = (char)depth;
  return never ? depth : recurse(depth + 1) + frame[0];
}

void* XML_ParserCreate(const char* encoding)
{
  void* (*real)(const char*) = (void* (*)(const char*))dlsym(RTLD_NEXT, "XML_ParserCreate");
  static int calls = 0;
  const char* when = getenv("MCOR_READER_CALL");
  if (++calls < (when ? atoi(when) : 1))
  {
    return real(encoding);
  }
  if (is_variable("MCOR_READER", "abort"))
  {
    abort();
  }
  if (is_variable("MCOR_READER", "recursion"))
  {
    recurse(0);
  }
  if (is_variable("MCOR_READER", "fault"))
  {
    *(volatile int*)(size_t)never = 1;
  }
  return real(encoding);
}
