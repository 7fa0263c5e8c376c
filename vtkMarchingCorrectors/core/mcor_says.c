/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* The sentences of mcor_says.def, and the words that fill their slots, such as {cube_size}. */

#include "mcor_internal.h"

#include <ctype.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const struct
{
  const char *name, *text;
} mcor_sentences[MCOR_SAYS_COUNT] = {
  { "NOTHING", "" },
#define SAYS(code, text) { #code, text },
#include "mcor_says.def"
};

/* The words for each slot of a sentence. label: the words in panels. If label is "", the words are
 * made from `property`, the option's name in VTK's filters: "CubeSize" becomes "Cube Size". */
static const struct
{
  const char *slot, *label, *property;
} mcor_slots[] = {
#define SLOT(slot, label) { slot, label, "" },
#include "mcor_says.def"
#define BOUNDS(member, scope, property) { #member, "", property },
#define OPTION(member, usual, legal, words, scope, property) { #member, "", property },
#include "mcor_options.def"
};

#define MCOR_SLOT_COUNT ((int)(sizeof mcor_slots / sizeof mcor_slots[0]))

const char* mcor_says_name(mcor_says code)
{
  return (unsigned)code < MCOR_SAYS_COUNT ? mcor_sentences[code].name : NULL;
}

const char* mcor_says_text(mcor_says code)
{
  return (unsigned)code < MCOR_SAYS_COUNT ? mcor_sentences[code].text : NULL;
}

/* Returns the index of the slot in mcor_slots; -1: there is no such slot. */
static int mcor_find_slot(const char* slot)
{
  for (int i = 0; i < MCOR_SLOT_COUNT; ++i)
  {
    if (strcmp(mcor_slots[i].slot, slot) == 0)
    {
      return i;
    }
  }
  return -1;
}

int mcor_member_word(void* user, const char* name, const char* value, char* word, size_t size)
{
  (void)user;
  snprintf(word, size, "%s%s%s", name, *value ? "=" : "", value);
  return mcor_find_slot(name) >= 0;
}

int mcor_label_word(void* user, const char* name, const char* value, char* word, size_t size)
{
  char whole[MCOR_WORD_SIZE];
  snprintf(whole, sizeof whole, "%s %s", name, value);
  const int with_value = mcor_find_slot(whole), row = mcor_find_slot(name);
  if (with_value >= 0)
  {
    snprintf(word, size, "%s", mcor_slots[with_value].label);
    return 1;
  }
  char label[MCOR_WORD_SIZE] = "", *end = label;
  for (const char* p = row >= 0 ? mcor_slots[row].property : ""; *p; ++p)
  {
    const char* gap = end > label && isupper((unsigned char)*p) ? " " : "";
    end += snprintf(end, sizeof label - (size_t)(end - label), "%s%c", gap, *p);
  }
  const char* words = row >= 0 && *mcor_slots[row].label ? mcor_slots[row].label : label;
  snprintf(word, size, "%s%s%s", words, *value ? " " : "", value);
  (void)user;
  return *words != 0;
}

/* Reads the slot {name} or {name value} at the beginning of the text. Returns the slot's length; 0:
 * the text does not begin with a slot. */
static int mcor_read_slot(const char* text, char name[128], char value[256])
{
#define MCOR_SLOT_NAME "{%127[abcdefghijklmnopqrstuvwxyz_]"
  int length = 0;
  *value = 0;
  if (*text == '{' && sscanf(text, MCOR_SLOT_NAME "}%n", name, &length) == 1 && length == 0)
  {
    sscanf(text, MCOR_SLOT_NAME "%*1[ ]%255[^}]}%n", name, value, &length);
  }
  return length;
}

size_t mcor_fill_text(const char* text, mcor_word word, void* user, char* out, size_t size)
{
  size_t used = 0;
  word = word ? word : mcor_member_word;
  while (*text)
  {
    char name[128], value[256], filled[MCOR_WORD_SIZE] = "";
    const int slot = mcor_read_slot(text, name, value);
    const bool is_slot = slot > 0 &&
      (word(user, name, value, filled, sizeof filled) ||
        mcor_member_word(NULL, name, value, filled, sizeof filled));
    const char* piece = is_slot ? filled : text;
    const size_t length = is_slot ? strlen(filled) : 1;
    for (size_t i = 0; i < length; ++i, ++used)
    {
      if (used + 1 < size)
      {
        out[used] = piece[i];
      }
    }
    text += is_slot ? slot : 1;
  }
  if (size > 0)
  {
    out[used < size ? used : size - 1] = 0;
  }
  return used;
}

char* mcor_fill_slots(const char* text, mcor_word word, void* user)
{
  const size_t size = text ? mcor_fill_text(text, word, user, NULL, 0) + 1 : 0;
  char* out = text ? malloc(size) : NULL;
  if (out)
  {
    mcor_fill_text(text, word, user, out, size);
  }
  return out;
}

#if defined(__GNUC__)
__attribute__((format(printf, 1, 0)))
#endif
static char*
mcor_write_text(const char* format, va_list arguments)
{
  va_list again;
  va_copy(again, arguments);
  const int length = vsnprintf(NULL, 0, format, arguments);
  char* text = length < 0 ? NULL : malloc((size_t)length + 1);
  if (text)
  {
    vsnprintf(text, (size_t)length + 1, format, again);
  }
  va_end(again);
  return text;
}

char* mcor_text(const char* format, ...)
{
  va_list arguments;
  va_start(arguments, format);
  char* text = mcor_write_text(format, arguments);
  va_end(arguments);
  return text;
}

char* mcor_append(char* text, const char* format, ...)
{
  va_list arguments;
  va_start(arguments, format);
  char* more = mcor_write_text(format, arguments);
  va_end(arguments);
  char* whole = text && more ? mcor_text("%s%s", text, more) : NULL;
  free(text);
  free(more);
  return whole;
}

bool mcor_contains(const char* text, const char* part)
{
  for (; *text; ++text)
  {
    size_t i = 0;
    while (part[i] && mcor_small_letter(text[i]) == mcor_small_letter(part[i]))
    {
      ++i;
    }
    if (!part[i])
    {
      return true;
    }
  }
  return false;
}

mcor_message mcor_say(mcor_says code, const char* format, ...)
{
  va_list arguments;
  va_start(arguments, format);
  const mcor_message message = { code, mcor_write_text(format, arguments) };
  va_end(arguments);
  return message;
}

void mcor_free_message(mcor_message* message)
{
  free(message->text);
  *message = MCOR_NO_MESSAGE;
}
