/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* The program "ld" for PoCL: turns the object file of a compiled kernel into a shared library.
 *
 * PoCL compiles by itself, but then calls the system's linker with the compiler's libraries. That
 * takes ten times as long as this one, for each kernel; and PyPI's PoCL ends the process where they
 * are missing, as on every machine without a compiler. Its objects need none of them: no data, one
 * kind of relocation, seldom a function of libc. So linking one is laying out its sections, filling
 * in distances, and a table of symbols. Whatever else it is called for, and every object that has
 * more, goes to the next "ld" on the PATH. For x86-64.
 *
 * Found by COMPILER_PATH, which processes of our own set (mcor_compile.c, OwnLinker.cxx), and in the
 * wheel by PATH. */

#include <elf.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#define PAGE 4096
#define STUB 8 /* bytes of a stub, and of its slot */

typedef struct bytes
{
  unsigned char* data;
  size_t size;
} bytes;

typedef struct linker
{
  bytes object, image;
  const Elf64_Shdr* sections;
  const Elf64_Sym* symbols;
  const char* names; /* of symbols */
  size_t section_count, symbol_count, names_size;
  uint64_t* address; /* [section_count], 0: not loaded */
  uint64_t* foreign; /* [symbol_count], number of an undefined symbol plus 1; 0: it is defined */
  size_t foreign_count;
  uint64_t code, code_end, stubs, data, slots, dynamic; /* addresses in the image */
  uint64_t hash, dynsym, dynstr, rela;
} linker;

static const Elf64_Ehdr* header(const linker* l)
{
  return (const Elf64_Ehdr*)l->object.data;
}

static uint64_t align(uint64_t at, uint64_t to)
{
  return to > 1 ? (at + to - 1) / to * to : at;
}

static int is_inside(const linker* l, uint64_t begin, uint64_t size)
{
  return begin <= l->object.size && size <= l->object.size - begin;
}

static int read_file(const char* path, bytes* into)
{
  FILE* file = fopen(path, "rb");
  struct stat about;
  int done = 0;
  if (file && fstat(fileno(file), &about) == 0 && about.st_size > 0)
  {
    into->size = (size_t)about.st_size;
    into->data = malloc(into->size);
    done = into->data && fread(into->data, 1, into->size, file) == into->size;
  }
  if (file)
  {
    fclose(file);
  }
  return done;
}

/* Finds the tables; false where the file is nothing for us. */
static int open_object(linker* l)
{
  const Elf64_Ehdr* h = header(l);
  if (l->object.size < sizeof *h || memcmp(h->e_ident, ELFMAG, SELFMAG) != 0 ||
    h->e_machine != EM_X86_64 || h->e_type != ET_REL || h->e_shentsize != sizeof(Elf64_Shdr) ||
    !is_inside(l, h->e_shoff, (uint64_t)h->e_shnum * sizeof(Elf64_Shdr)))
  {
    return 0;
  }
  l->sections = (const Elf64_Shdr*)(l->object.data + h->e_shoff);
  l->section_count = h->e_shnum;
  for (size_t s = 0; s < l->section_count; ++s)
  {
    const Elf64_Shdr* section = l->sections + s;
    if (section->sh_type != SHT_NOBITS && !is_inside(l, section->sh_offset, section->sh_size))
    {
      return 0;
    }
    if (section->sh_type == SHT_SYMTAB && section->sh_link < l->section_count)
    {
      const Elf64_Shdr* names = l->sections + section->sh_link;
      l->symbols = (const Elf64_Sym*)(l->object.data + section->sh_offset);
      l->symbol_count = section->sh_size / sizeof(Elf64_Sym);
      l->names = (const char*)l->object.data + names->sh_offset;
      l->names_size = names->sh_size;
    }
  }
  l->address = calloc(l->section_count, sizeof *l->address);
  l->foreign = calloc(l->symbol_count + 1, sizeof *l->foreign);
  return l->symbols && l->address && l->foreign && l->names_size > 0 &&
    l->names[l->names_size - 1] == '\0';
}

/* Unwinding tables need no place: no exception passes through a kernel. */
static int is_loaded(const linker* l, size_t s)
{
  const Elf64_Shdr* names = l->sections + header(l)->e_shstrndx;
  const char* name = (const char*)l->object.data + names->sh_offset + l->sections[s].sh_name;
  return (l->sections[s].sh_flags & SHF_ALLOC) && l->sections[s].sh_size > 0 &&
    strcmp(name, ".eh_frame") != 0;
}

static uint64_t place(linker* l, uint64_t at, uint64_t flags)
{
  for (size_t s = 1; s < l->section_count; ++s)
  {
    const Elf64_Shdr* section = l->sections + s;
    if (is_loaded(l, s) && (section->sh_flags & (SHF_WRITE | SHF_EXECINSTR)) == flags)
    {
      l->address[s] = align(at, section->sh_addralign);
      at = l->address[s] + section->sh_size;
    }
  }
  return at;
}

/* Read-only: headers, tables, constants; then code; then what may be written. */
static int lay_out(linker* l)
{
  for (size_t i = 1; i < l->symbol_count; ++i)
  {
    const Elf64_Sym* symbol = l->symbols + i;
    if (symbol->st_name >= l->names_size ||
      (symbol->st_shndx >= l->section_count && symbol->st_shndx < SHN_LORESERVE) ||
      symbol->st_shndx == SHN_COMMON)
    {
      return 0;
    }
    if (symbol->st_shndx == SHN_UNDEF)
    {
      l->foreign[i] = ++l->foreign_count;
    }
  }
  l->hash = align(sizeof(Elf64_Ehdr) + 5 * sizeof(Elf64_Phdr), 8);
  l->dynsym = align(l->hash + (3 + l->symbol_count) * sizeof(Elf64_Word), 8);
  l->dynstr = l->dynsym + l->symbol_count * sizeof(Elf64_Sym);
  /* Behind the symbols' names those of two libraries. */
  l->rela = align(l->dynstr + l->names_size + 32, 8);
  l->code = align(place(l, l->rela + l->foreign_count * sizeof(Elf64_Rela), 0), PAGE);
  l->stubs = align(place(l, l->code, SHF_EXECINSTR), STUB);
  l->code_end = l->stubs + l->foreign_count * STUB;
  l->data = align(l->code_end, PAGE);
  l->slots = align(place(l, l->data, SHF_WRITE), STUB);
  l->dynamic = l->slots + l->foreign_count * STUB;
  l->image.size = l->dynamic + 12 * sizeof(Elf64_Dyn);
  l->image.data = l->image.size < (size_t)1 << 30 ? calloc(l->image.size, 1) : NULL;
  for (size_t s = 1; l->image.data && s < l->section_count; ++s)
  {
    if (l->address[s] && l->sections[s].sh_type != SHT_NOBITS)
    {
      memcpy(l->image.data + l->address[s], l->object.data + l->sections[s].sh_offset,
        l->sections[s].sh_size);
    }
  }
  return l->image.data != NULL;
}

/* Where a distance to this symbol ends; 0: nowhere. */
static uint64_t target(const linker* l, uint64_t symbol, uint32_t type)
{
  const uint64_t number = l->foreign[symbol];
  const int by_slot =
    type == R_X86_64_GOTPCREL || type == R_X86_64_GOTPCRELX || type == R_X86_64_REX_GOTPCRELX;
  if (number)
  {
    return (by_slot ? l->slots : l->stubs) + (number - 1) * STUB;
  }
  const uint16_t section = l->symbols[symbol].st_shndx;
  const uint64_t begin = section < l->section_count ? l->address[section] : 0;
  return by_slot || !begin ? 0 : begin + l->symbols[symbol].st_value;
}

static int relocate_section(linker* l, const Elf64_Shdr* table)
{
  const uint64_t begin = l->address[table->sh_info];
  const Elf64_Rela* entries = (const Elf64_Rela*)(l->object.data + table->sh_offset);
  for (size_t i = 0; i < table->sh_size / sizeof *entries; ++i)
  {
    const uint32_t type = (uint32_t)ELF64_R_TYPE(entries[i].r_info);
    const uint64_t symbol = ELF64_R_SYM(entries[i].r_info);
    const uint64_t at = begin + entries[i].r_offset;
    const uint64_t to = symbol < l->symbol_count ? target(l, symbol, type) : 0;
    const int64_t distance = (int64_t)(to + (uint64_t)entries[i].r_addend - at);
    const int32_t field = (int32_t)distance;
    const int known = type == R_X86_64_PC32 || type == R_X86_64_PLT32 ||
      type == R_X86_64_GOTPCREL || type == R_X86_64_GOTPCRELX || type == R_X86_64_REX_GOTPCRELX;
    if (!known || !to || field != distance || at + sizeof field > l->image.size)
    {
      return 0;
    }
    memcpy(l->image.data + at, &field, sizeof field);
  }
  return 1;
}

static int relocate(linker* l)
{
  for (size_t s = 1; s < l->section_count; ++s)
  {
    const Elf64_Shdr* table = l->sections + s;
    const int counts = (table->sh_type == SHT_RELA || table->sh_type == SHT_REL) &&
      table->sh_info < l->section_count && l->address[table->sh_info];
    if (counts && (table->sh_type == SHT_REL || !relocate_section(l, table)))
    {
      return 0;
    }
  }
  return 1;
}

/* What the loader looks symbols up by: one chain through all of them. */
static void write_symbols(linker* l)
{
  Elf64_Word* hash = (Elf64_Word*)(l->image.data + l->hash);
  Elf64_Sym* symbols = (Elf64_Sym*)(l->image.data + l->dynsym);
  Elf64_Rela* rela = (Elf64_Rela*)(l->image.data + l->rela);
  memcpy(l->image.data + l->dynstr, l->names, l->names_size);
  memcpy(l->image.data + l->dynstr + l->names_size, "libc.so.6\0libm.so.6", 20);
  hash[0] = 1;
  hash[1] = (Elf64_Word)l->symbol_count;
  hash[2] = l->symbol_count > 1 ? 1 : 0;
  for (size_t i = 1; i < l->symbol_count; ++i)
  {
    const uint64_t number = l->foreign[i];
    hash[3 + i] = i + 1 < l->symbol_count ? (Elf64_Word)(i + 1) : 0;
    symbols[i] = l->symbols[i];
    if (number)
    {
      const uint64_t stub = l->stubs + (number - 1) * STUB, slot = l->slots + (number - 1) * STUB;
      const int32_t distance = (int32_t)(slot - (stub + 6));
      memcpy(l->image.data + stub, "\xff\x25", 2); /* jmp *distance(%rip) */
      memcpy(l->image.data + stub + 2, &distance, sizeof distance);
      rela[number - 1] = (Elf64_Rela){ slot, ELF64_R_INFO(i, R_X86_64_GLOB_DAT), 0 };
    }
    else if (ELF64_ST_BIND(symbols[i].st_info) == STB_LOCAL)
    {
      memset(symbols + i, 0, sizeof *symbols);
    }
    else if (symbols[i].st_shndx < l->section_count)
    {
      symbols[i].st_value += l->address[symbols[i].st_shndx];
      symbols[i].st_shndx = 1; /* defined, in no section that there is */
    }
  }
}

static void write_headers(linker* l)
{
  const uint64_t size = l->image.size, names = l->names_size;
  const Elf64_Phdr segments[] = {
    { PT_LOAD, PF_R, 0, 0, 0, l->code, l->code, PAGE },
    { PT_LOAD, PF_R | PF_X, l->code, l->code, l->code, l->code_end - l->code, l->code_end - l->code,
      PAGE },
    { PT_LOAD, PF_R | PF_W, l->data, l->data, l->data, size - l->data, size - l->data, PAGE },
    { PT_DYNAMIC, PF_R | PF_W, l->dynamic, l->dynamic, l->dynamic, size - l->dynamic,
      size - l->dynamic, 8 },
    { PT_GNU_STACK, PF_R | PF_W, 0, 0, 0, 0, 0, 16 },
  };
  const Elf64_Dyn entries[] = { { DT_NEEDED, { names } }, { DT_NEEDED, { names + 10 } },
    { DT_HASH, { l->hash } }, { DT_STRTAB, { l->dynstr } }, { DT_SYMTAB, { l->dynsym } },
    { DT_STRSZ, { names + 20 } }, { DT_SYMENT, { sizeof(Elf64_Sym) } },
    { DT_RELAENT, { sizeof(Elf64_Rela) } },
    { DT_RELASZ, { l->foreign_count * sizeof(Elf64_Rela) } },
    { l->foreign_count ? DT_RELA : DT_DEBUG, { l->foreign_count ? l->rela : 0 } },
    { DT_NULL, { 0 } } };
  Elf64_Ehdr* h = (Elf64_Ehdr*)l->image.data;
  memcpy(h->e_ident, header(l)->e_ident, EI_NIDENT);
  h->e_type = ET_DYN;
  h->e_machine = EM_X86_64;
  h->e_version = EV_CURRENT;
  h->e_phoff = h->e_ehsize = sizeof *h;
  h->e_phentsize = sizeof *segments;
  h->e_phnum = sizeof segments / sizeof *segments;
  h->e_shentsize = sizeof(Elf64_Shdr);
  memcpy(l->image.data + h->e_phoff, segments, sizeof segments);
  memcpy(l->image.data + l->dynamic, entries, sizeof entries);
}

static int write_file(const linker* l, const char* path)
{
  FILE* file = fopen(path, "wb");
  const int written = file && fwrite(l->image.data, 1, l->image.size, file) == l->image.size;
  const int closed = file && fclose(file) == 0;
  return written && closed && chmod(path, 0755) == 0;
}

static int link_kernel(const char* input, const char* output)
{
  linker l = { 0 };
  const int done = read_file(input, &l.object) && open_object(&l) && lay_out(&l) && relocate(&l);
  if (done)
  {
    write_symbols(&l);
    write_headers(&l);
  }
  const int written = done && write_file(&l, output);
  free(l.object.data);
  free(l.image.data);
  free(l.address);
  free(l.foreign);
  return written;
}

/* The next ld on the PATH that is not this program. */
static int run_next(char** arguments)
{
  struct stat own, other;
  const char* path = getenv("PATH");
  char name[4096];
  const int known = stat("/proc/self/exe", &own) == 0;
  while (known && path && *path)
  {
    const size_t length = strcspn(path, ":");
    snprintf(name, sizeof name, "%.*s/ld", (int)length, path);
    if (stat(name, &other) == 0 && (other.st_ino != own.st_ino || other.st_dev != own.st_dev))
    {
      execv(name, arguments);
    }
    path += length + (path[length] == ':');
  }
  fprintf(
    stderr, "ld of marching-correctors: this needs a linker of the system (Debian: binutils).\n");
  return 1;
}

int main(int count, char** arguments)
{
  const char *input = NULL, *output = NULL;
  int inputs = 0;
  for (int i = 1; i < count; ++i)
  {
    const char* base = strrchr(arguments[i], '/');
    const size_t length = strlen(arguments[i]);
    if (strcmp(arguments[i], "-o") == 0 && i + 1 < count)
    {
      output = arguments[++i];
    }
    else if (length > 2 && strcmp(arguments[i] + length - 2, ".o") == 0)
    {
      ++inputs;
      /* So PoCL calls its objects. */
      input = base && strncmp(base, "/tempfile", 9) == 0 ? arguments[i] : NULL;
    }
  }
  return inputs == 1 && input && output && link_kernel(input, output) ? 0 : run_next(arguments);
}
