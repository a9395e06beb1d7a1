#!/usr/bin/env python3
"""A plain PyTorch model of the same size, as its users write it, to compare with.

Pre-norm GPT: learned positions, nn.Linear, nn.LayerNorm, softmax attention with a mask, GELU, AdamW,
32-bit floats, all cores; sampling feeds the whole context for every token, without a cache. Prints, or
with --json writes, tokens a second in the form that bench/collect reads.

    python3 bench/peers/pytorch_peer.py [--json FILE] [--models AB] [--steps 2] [--tokens 3]

Debian: apt-get install python3-torch
"""
import argparse
import json
import math
import sys
import time

import torch
import torch.nn as nn
import torch.nn.functional as F

# name: layers, heads, width, batch, how many times its training rate ours should reach
MODELS = {"A": (8, 8, 512, 4, 7.0), "B": (4, 4, 128, 8, 12.0)}
CONTEXT, VOCABULARY = 1024, 512


class Attention(nn.Module):
    def __init__(self, heads, width):
        super().__init__()
        self.heads = heads
        self.qkv = nn.Linear(width, 3 * width)
        self.out = nn.Linear(width, width)
        self.register_buffer("mask", torch.tril(torch.ones(CONTEXT, CONTEXT)).view(1, 1, CONTEXT, CONTEXT))

    def forward(self, x):
        b, t, c = x.shape
        q, k, v = (y.view(b, t, self.heads, c // self.heads).transpose(1, 2) for y in self.qkv(x).split(c, dim=2))
        scores = q @ k.transpose(-2, -1) / math.sqrt(c // self.heads)
        scores = scores.masked_fill(self.mask[:, :, :t, :t] == 0, float("-inf"))
        y = F.softmax(scores, dim=-1) @ v
        return self.out(y.transpose(1, 2).contiguous().view(b, t, c))


class Block(nn.Module):
    def __init__(self, heads, width):
        super().__init__()
        self.norm1, self.norm2 = nn.LayerNorm(width), nn.LayerNorm(width)
        self.attention = Attention(heads, width)
        self.mlp = nn.Sequential(nn.Linear(width, 4 * width), nn.GELU(), nn.Linear(4 * width, width))

    def forward(self, x):
        x = x + self.attention(self.norm1(x))
        return x + self.mlp(self.norm2(x))


class Transformer(nn.Module):
    def __init__(self, layers, heads, width):
        super().__init__()
        self.tokens = nn.Embedding(VOCABULARY, width)
        self.positions = nn.Embedding(CONTEXT, width)
        self.blocks = nn.ModuleList([Block(heads, width) for _ in range(layers)])
        self.norm = nn.LayerNorm(width)
        self.head = nn.Linear(width, VOCABULARY, bias=False)

    def forward(self, ids):
        x = self.tokens(ids) + self.positions(torch.arange(ids.shape[1]))
        for block in self.blocks:
            x = block(x)
        return self.head(self.norm(x))


def train_rate(model, batch, steps):
    """Tokens a second of `steps` steps after one to warm up."""
    model.train()
    optimizer = torch.optim.AdamW(model.parameters(), lr=3e-4)
    ids = torch.randint(VOCABULARY, (batch, CONTEXT + 1))
    for step in range(steps + 1):
        if step == 1:
            start = time.perf_counter()
        loss = F.cross_entropy(model(ids[:, :-1]).reshape(-1, VOCABULARY), ids[:, 1:].reshape(-1))
        optimizer.zero_grad()
        loss.backward()
        torch.nn.utils.clip_grad_norm_(model.parameters(), 1.0)
        optimizer.step()
    return steps * batch * CONTEXT / (time.perf_counter() - start)


@torch.no_grad()
def sample_rate(model, context, tokens):
    """Tokens a second where each is drawn from a forward pass over all before it."""
    model.eval()
    ids = torch.randint(VOCABULARY, (1, context))
    for token in range(tokens + 1):
        if token == 1:
            start = time.perf_counter()
        logits = model(ids[:, -CONTEXT:])[:, -1]
        ids = torch.cat((ids, torch.multinomial(F.softmax(logits, dim=-1), 1)), dim=1)
    return tokens / (time.perf_counter() - start)


def measure(name, options):
    layers, heads, width, batch, goal = MODELS[name]
    torch.manual_seed(1)
    model = Transformer(layers, heads, width)
    steps = options.steps if name == "A" else 2 * options.steps
    train = {
        "name": f"{name}: training, batch {batch}, plain PyTorch f32",
        "value": train_rate(model, batch, steps),
        "unit": "tokens/s",
        "peer_of": f"train/{name}",
        "goal": goal,
    }
    sample = {
        "name": f"{name}: sampling at context 512, no cache, plain PyTorch f32",
        "value": sample_rate(model, 512, options.tokens),
        "unit": "tokens/s",
    }
    return [train, sample]


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--json", help="write the results to this file")
    parser.add_argument("--models", default="AB", help="A, B or AB")
    parser.add_argument("--steps", type=int, default=2, help="timed training steps of A; twice as many of B")
    parser.add_argument("--tokens", type=int, default=8, help="timed tokens of sampling")
    options = parser.parse_args()
    unknown = set(options.models) - set(MODELS)
    if unknown or options.steps < 1 or options.tokens < 1:
        parser.error("--models is one of A, B, AB; --steps and --tokens are at least 1")
    results = [result for name in options.models for result in measure(name, options)]
    text = json.dumps({"bench": "pytorch", "torch": torch.__version__, "threads": torch.get_num_threads(),
                       "results": results}, indent=2)
    if options.json:
        with open(options.json, "w") as out:
            out.write(text + "\n")
    for result in results:
        print(f"{result['name']:60} {result['value']:10.1f} {result['unit']}", file=sys.stderr)
    if not options.json:
        print(text)


if __name__ == "__main__":
    main()
