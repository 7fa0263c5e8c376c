/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Runs the fuzz target without a fuzzer: on the named files, then, with --random N, on N random
 * inputs, which are the same on every machine. */

#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size);

#define FUZZ_LARGEST 512

static int fuzz_run_file(const char* name)
{
  static uint8_t buffer[1 << 16];
  FILE* file = fopen(name, "rb");
  if (!file)
  {
    fprintf(stderr, "%s cannot be read\n", name);
    return 0;
  }
  const size_t size = fread(buffer, 1, sizeof buffer, file);
  fclose(file);
  uint8_t* data = malloc(size + (size == 0)); /* the block is exactly as large as the input */
  if (!data)
  {
    return 0;
  }
  memcpy(data, buffer, size);
  printf("%s\n", name);
  fflush(stdout);
  LLVMFuzzerTestOneInput(data, size);
  free(data);
  return 1;
}

static void fuzz_run_random(uint64_t number)
{
  uint8_t data[FUZZ_LARGEST];
  uint64_t state = number * 0x9E3779B97F4A7C15u + 1;
  const size_t size = 30 + number * 7 % (FUZZ_LARGEST - 30);
  for (size_t i = 0; i < size; ++i)
  {
    state = state * 6364136223846793005u + 1442695040888963407u;
    data[i] = (uint8_t)(state >> 56);
  }
  LLVMFuzzerTestOneInput(data, size);
}

int main(int argc, char** argv)
{
  int good = 1;
  for (int i = 1; i < argc; ++i)
  {
    if (strcmp(argv[i], "--random") == 0 && i + 1 < argc)
    {
      const long count = strtol(argv[++i], NULL, 10);
      for (long n = 0; n < count; ++n)
      {
        printf("random %ld\n", n);
        fflush(stdout);
        fuzz_run_random((uint64_t)n);
      }
      continue;
    }
    good = fuzz_run_file(argv[i]) && good;
  }
  return good ? 0 : 1;
}
